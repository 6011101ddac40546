#pragma once

#include <cstdint>

#include "graticule/problems/mapping/cell_bits.hpp"
#include "graticule/problems/mapping/live_map_options.hpp"

namespace graticule {

/// Exact counts of a tile's cells, in bit planes: bit i of every cell's count is in plane i, so
/// that 256 counters are added to at once.
struct VoteTile {
  /// So many votes a cell can hold: the number of nodes that a map composites is kept below.
  static constexpr int kPlanes = 20;
  CellBits hits[kPlanes], passes[kPlanes];
  std::uint8_t hit_planes = 0, pass_planes = 0;  // those above are zero
};

/// Adds one to the count of `plus`' cells, takes one off `minus`': no cell is in both.
inline void Count(const CellBits& plus, const CellBits& minus, CellBits* planes,
                  std::uint8_t* used) {
  CellBits carry = plus, borrow = minus;
  for (int i = 0; (carry | borrow).Any(); ++i) {
    const CellBits before = planes[i];
    planes[i] = before ^ (carry | borrow);
    carry = carry & before;
    borrow = borrow & ~before;
    if (i >= *used) *used = static_cast<std::uint8_t>(i + 1);
  }
}

/// Adds counts given as planes.
void CountAll(const CellBits* plus, int plus_planes, CellBits* planes, std::uint8_t* used);

/// What a rule makes of a tile.
struct TileLabels {
  CellBits structure, free;
  CellBits removed;  ///< free, though some scan ended a beam there: what has passed through
};
TileLabels LabelTile(const VoteTile& tile, const VoteRule& rule);

}  // namespace graticule
