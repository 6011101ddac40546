#pragma once

#include <cstdint>

namespace graticule {

/// The lattice of cells is fixed to the world: cell (x, y) is [x, x + 1) * resolution in x, and so
/// in y.  A tile is 16 x 16 cells, tile (x, y) those from cell (16 x, 16 y).
constexpr int kTileSide = 16;

/// Where a tile is in the lattice of tiles.  Ordered row by row.
struct TileIndex {
  std::int32_t x = 0, y = 0;
  friend bool operator==(const TileIndex& a, const TileIndex& b) {
    return a.x == b.x && a.y == b.y;
  }
  friend bool operator<(const TileIndex& a, const TileIndex& b) {
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  }
};

/// One bit a cell of a tile.  Cell (x, y) of the tile is bit 16 (y % 4) + x of word y / 4.
struct CellBits {
  std::uint64_t words[4] = {0, 0, 0, 0};

  bool Any() const { return ((words[0] | words[1]) | (words[2] | words[3])) != 0; }
  bool Test(int x, int y) const { return (words[y >> 2] >> (16 * (y & 3) + x)) & 1; }
  void Set(int x, int y) { words[y >> 2] |= std::uint64_t{1} << (16 * (y & 3) + x); }
  int Count() const {
    // Without an instruction for it, which x86-64 has not to begin with: sums in fields of 2, 4, 8
    // bits, of all words at once.
    constexpr std::uint64_t k2 = 0x5555555555555555, k4 = 0x3333333333333333,
                            k8 = 0x0f0f0f0f0f0f0f0f, k16 = 0x00ff00ff00ff00ff;
    std::uint64_t bytes = 0;
    for (std::uint64_t word : words) {
      word -= (word >> 1) & k2;
      word = (word & k4) + ((word >> 2) & k4);
      bytes += (word + (word >> 4)) & k8;
    }
    bytes = (bytes & k16) + ((bytes >> 8) & k16);
    return static_cast<int>((bytes * 0x0001000100010001) >> 48);
  }
  friend CellBits operator&(const CellBits& a, const CellBits& b) {
    CellBits r;
    for (int i = 0; i < 4; ++i) r.words[i] = a.words[i] & b.words[i];
    return r;
  }
  friend CellBits operator|(const CellBits& a, const CellBits& b) {
    CellBits r;
    for (int i = 0; i < 4; ++i) r.words[i] = a.words[i] | b.words[i];
    return r;
  }
  friend CellBits operator^(const CellBits& a, const CellBits& b) {
    CellBits r;
    for (int i = 0; i < 4; ++i) r.words[i] = a.words[i] ^ b.words[i];
    return r;
  }
  friend CellBits operator~(const CellBits& a) {
    CellBits r;
    for (int i = 0; i < 4; ++i) r.words[i] = ~a.words[i];
    return r;
  }
  friend bool operator==(const CellBits& a, const CellBits& b) { return !(a ^ b).Any(); }
  friend bool operator!=(const CellBits& a, const CellBits& b) { return (a ^ b).Any(); }
};

/// Calls f(x, y) for each cell that is set, row by row from the bottom.
template <class F>
void ForEachCell(const CellBits& bits, F f) {
  for (int i = 0; i < 4; ++i)
    for (std::uint64_t word = bits.words[i]; word; word &= word - 1) {
      const int bit = __builtin_ctzll(word);
      f(bit & 15, 4 * i + (bit >> 4));
    }
}

}  // namespace graticule
