#pragma once

#include <vector>

#include "graticule/problems/mapping/rasteriser.hpp"
#include "graticule/problems/mapping/vote_grid.hpp"

namespace graticule {

/// The sub-map of a slice as the thesis has it (section 2.3): all tiles of its bounding box,
/// counted together.  For comparison.
class DenseSlice {
 public:
  void Draw(const std::vector<const std::vector<ScanTile>*>& drawings);
  /// compositeOnto of Algorithm 2.1.
  void CompositeOnto(VoteGrid* grid) const;

 private:
  TileIndex low_, high_{-1, -1};
  int planes_ = 0;                       // of a count
  std::vector<CellBits> passes_, hits_;  // planes_ a tile, row by row
};

}  // namespace graticule
