#pragma once

#include <cstdint>
#include <memory>

#include "graticule/problems/mapping/cell_bits.hpp"
#include "graticule/problems/mapping/live_map_options.hpp"
#include "graticule/problems/mapping/page_grid.hpp"

namespace graticule {

/// So many votes a cell can hold, as bits: the number of nodes that a map composites is kept below.
constexpr int kVotePlanes = 20;

/// Adds one to the count of `plus`' cells, takes one off `minus`': no cell is in both.  Counts are
/// bit planes, bit i of every cell's count in plane(i), so that 256 counters are added to at once.
template <class PlaneAt>
void Count(const CellBits& plus, const CellBits& minus, PlaneAt plane) {
  CellBits carry = plus, borrow = minus;
  for (int i = 0; (carry | borrow).Any(); ++i) {
    CellBits& bits = plane(i);
    const CellBits before = bits;
    bits = before ^ (carry | borrow);
    carry = carry & before;
    borrow = borrow & ~before;
  }
}

/// Exact counts of a page's cells.  A plane of all its tiles is made when it is needed first: few
/// cells have many votes, and the planes that change most lie together.
class PageCounts {
 public:
  /// See Count.
  void Add(int tile, const CellBits& plus, const CellBits& minus) {
    Count(plus, minus, [this, tile](int i) -> CellBits& { return Writable(i, tile); });
  }
  /// Adds counts given as `count` planes.
  void Add(int tile, const CellBits* plus, int count);
  void Clear();
  /// Has the processor fetch what Add will need of a tile: to wait for the memory then may take
  /// longer than all else.
  void Expect(int tile) const {
    for (int i = 0; i < used_ && i < 3; ++i) __builtin_prefetch(&planes_[i]->tiles[tile], 1);
  }

  int Planes() const { return used_; }  ///< those above are zero
  const CellBits& At(int plane, int tile) const { return planes_[plane]->tiles[tile]; }

 private:
  struct Plane {
    alignas(64) CellBits tiles[kPageTiles];
  };
  CellBits& Writable(int plane, int tile) {
    while (plane >= used_) Grow();  // a count may have no bit in the planes below
    return planes_[plane]->tiles[tile];
  }
  void Grow();

  int used_ = 0;
  std::unique_ptr<Plane> planes_[kVotePlanes];
};

/// What a rule makes of a tile.
struct TileLabels {
  CellBits structure, free;
  CellBits removed;  ///< free, though some scan ended a beam there: what has passed through
};
TileLabels LabelTile(const PageCounts& hits, const PageCounts& passes, int tile,
                     const VoteRule& rule);

}  // namespace graticule
