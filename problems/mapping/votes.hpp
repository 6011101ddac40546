#pragma once

#include <cstdint>

#include "graticule/problems/mapping/cell_bits.hpp"

namespace graticule {

/// How a cell's hits and passes become a label (thesis section 2.5): every scan that ends a beam in
/// the cell, or passes it, is a vote of fixed log odds, as integers.
///   score = hit_votes * hits - pass_votes * passes + bias
/// structure where score >= structure_from; free where the cell was seen and score <= free_to;
/// unknown elsewhere.
struct VoteRule {
  int hit_votes = 3;   ///< 1 .. 15
  int pass_votes = 1;  ///< 1 .. 15
  /// The designer's bias: above 0 resists misalignment (walls stay), below 0 clears doorways
  /// sooner.
  int bias = 0;
  int structure_from = 1;
  int free_to = 0;  ///< below structure_from
  /// Hits, and passes, beyond this many of a cell are not counted when it is labelled; the counts
  /// themselves stay exact.  2^n - 1; 0: no limit.
  int saturation = 0;
};

/// Throws Error: a weight, limit or threshold out of range.
void CheckVoteRule(const VoteRule& rule);

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
