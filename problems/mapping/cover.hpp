#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "graticule/problems/mapping/live_map_options.hpp"
#include "graticule/problems/mapping/page_grid.hpp"
#include "graticule/problems/mapping/rasteriser.hpp"
#include "graticule/problems/mapping/votes.hpp"

namespace graticule {

/// By how many nodes of a cover each cell was seen: what coverTest of Algorithm 2.1, line 3, asks.
/// Field of view and position are compared by what they are compared for, the cells that are seen
/// from there.
class CoverSight {
 public:
  /// What a node of the cover says of a tile, and what it says instead now.
  void Replace(const ScanTile& before, const ScanTile& after);
  /// See PageCounts.
  void Expect(TileIndex tile) const {
    const std::unique_ptr<PageCounts>* page = pages_.Find(PageOf(tile));
    if (page && *page) (*page)->Expect(PlaceInPage(tile));
  }
  /// coverTest: whether a scan adds to what is seen.
  bool Adds(const std::vector<ScanTile>& scan, const CoverOptions& options) const;

 private:
  PageGrid<std::unique_ptr<PageCounts>> pages_;
  PageCounts* last_ = nullptr;  // the page that was written to last
  TileIndex last_index_;
};

}  // namespace graticule
