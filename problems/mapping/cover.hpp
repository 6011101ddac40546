#pragma once

#include <cstddef>
#include <vector>

#include "graticule/problems/mapping/rasteriser.hpp"

namespace graticule {

/// Which nodes' scans the map is made of (thesis section 2.4).
struct CoverOptions {
  bool on = true;
  /// The dial.  A node is left out if no more than this share of the cells that it sees are news:
  /// have been seen by fewer than `views` nodes of the cover.  0: what adds a cell stays.
  double news = 0.05;
  int views =
      2;  ///< 1 .. 7: that each cell is to be seen by, so that transients are still voted out
  /// Whether what other robots have seen counts too, which goes beyond Algorithm 2.1.
  bool across_robots = false;
};

/// The tiles that a scan touches, and the box of these.
struct Footprint {
  std::vector<ScanTile> tiles;
  TileIndex low, high;

  /// After a change of `tiles`.
  void FindBox();
  bool Meets(const Footprint& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
           other.low.y <= high.y;
  }
};

/// coverTest of Algorithm 2.1, line 3: field of view and position are compared by what they are
/// compared for, the cells that the scan sees from there.
class CoverTest {
 public:
  CoverTest(const CoverOptions& options, const Footprint& candidate);

  /// Takes the scan of a node of the cover into account.  True as long as the candidate has to join
  /// the cover by what was taken into account so far.
  bool StillAdds(const Footprint& member);
  bool Adds() const { return news_ > allowed_; }

 private:
  struct Seen {
    CellBits at_least[7];  // by 1, 2, ... nodes
  };
  const Footprint& candidate_;
  int views_;
  std::vector<Seen> seen_;           // a tile of the candidate
  std::vector<std::int16_t> place_;  // of a tile, row by row in the candidate's box; -1: none
  double news_ = 0, allowed_ = 0;
};

}  // namespace graticule
