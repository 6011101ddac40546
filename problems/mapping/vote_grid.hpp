#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "graticule/problems/mapping/occupancy_map.hpp"
#include "graticule/problems/mapping/rasteriser.hpp"
#include "graticule/problems/mapping/votes.hpp"

namespace graticule {

struct CellIndex {
  std::int32_t x = 0, y = 0;
};

struct CellFlip {
  CellIndex cell;
  Occupancy from = Occupancy::kUnknown, to = Occupancy::kUnknown;
};

/// What a version of a map has that the one before had not.
struct MapChange {
  std::size_t dirty_tiles = 0;           ///< votes changed: looked at
  std::vector<TileIndex> changed_tiles;  ///< labels changed; in order
  std::vector<CellFlip> flips;
  std::vector<CellIndex> frontier_came, frontier_went;
};

/// Votes of all scans that are in the map, and which tiles' votes have changed since the last map
/// was made from them.
class VoteGrid {
 public:
  explicit VoteGrid(const VoteRule& rule) : rule_(rule) {}

  /// Takes what a scan said of a tile back, and says something else instead: exact.
  void Replace(const ScanTile& before, const ScanTile& after);
  /// Adds counts given as planes.
  void Add(TileIndex tile, const CellBits* passes, const CellBits* hits, int planes);
  /// See PageCounts.
  void Expect(TileIndex tile) const {
    const std::unique_ptr<Page>* page = pages_.Find(PageOf(tile));
    if (!page || !*page) return;
    (*page)->passes.Expect(PlaceInPage(tile));
    (*page)->hits.Expect(PlaceInPage(tile));
  }
  /// No votes at all; every tile that had some is dirty.
  void Clear();

  std::size_t DirtyTiles() const { return dirty_tiles_; }

  /// The map after `before`, which must be the one that this returned last: labels of dirty tiles
  /// are made anew, those of the others shared.  `before` itself if no label changed.
  std::shared_ptr<const OccupancyMap> Publish(const std::shared_ptr<const OccupancyMap>& before,
                                              MapChange* change);

 private:
  struct Page {
    PageCounts hits, passes;
    std::uint64_t used = 0, dirty = 0;  // a bit a tile
    TileIndex index;
  };

  Page& PageAt(TileIndex page);
  Page& Dirty(TileIndex tile);

  VoteRule rule_;
  PageGrid<std::unique_ptr<Page>> pages_;
  std::vector<Page*> dirty_pages_;
  std::size_t dirty_tiles_ = 0;
  Page* last_ = nullptr;  // the page that was asked for last
};

}  // namespace graticule
