#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/problems/mapping/cell_bits.hpp"
#include "graticule/problems/mapping/page_grid.hpp"

namespace graticule {

/// A box of cells.
struct CellBox {
  std::int32_t left = 0, bottom = 0;  ///< the lower left cell
  std::int32_t width = 0, height = 0;
  bool Has(std::int32_t x, std::int32_t y) const {
    return x >= left && y >= bottom && x - left < width && y - bottom < height;
  }
};

/// A tile of the map.  A cell is structure, free, or neither: unknown.
struct MapTile {
  CellBits structure, free;
  CellBits removed;   ///< free, though a beam once ended there: transients that were voted out
  CellBits frontier;  ///< free, and beside (left, right, above, below) an unknown cell
};

/// Tiles that are shared between versions of a map as long as none of them changes.
struct MapPage {
  MapTile tiles[kPageTiles];
  std::uint64_t changed_in[kPageTiles] = {};  ///< the version that a tile is of; 0: empty
  std::uint64_t newest = 0;                   ///< of those
};

/// The ternary map of a moment: it never changes, and any thread may read it.  A copy, and a new
/// version, share what is equal.  Cells are those of the lattice that is fixed to the world
/// (cell_bits.hpp), so that a cell keeps its index as the map grows.
class OccupancyMap {
 public:
  explicit OccupancyMap(double resolution) : resolution_(resolution) {}

  double Resolution() const { return resolution_; }  ///< m, a cell's side
  /// Grows by one with each change; 0: nothing was seen yet.
  std::uint64_t Version() const { return version_; }

  Occupancy At(std::int32_t x, std::int32_t y) const {
    const MapTile& tile = TileAt({x >> 4, y >> 4});
    if (tile.structure.Test(x & 15, y & 15)) return Occupancy::kStructure;
    return tile.free.Test(x & 15, y & 15) ? Occupancy::kFree : Occupancy::kUnknown;
  }
  /// Of the place (x, y) in the world, m.  Unknown far off and where not finite.
  Occupancy AtPlace(double x, double y) const;
  bool IsFrontier(std::int32_t x, std::int32_t y) const {
    return TileAt({x >> 4, y >> 4}).frontier.Test(x & 15, y & 15);
  }
  bool IsRemoved(std::int32_t x, std::int32_t y) const {
    return TileAt({x >> 4, y >> 4}).removed.Test(x & 15, y & 15);
  }

  /// An empty tile where nothing was seen.
  const MapTile& TileAt(TileIndex tile) const;
  /// The tiles that have changed since a version, in order: what a planner that has seen this
  /// version must look at again.  Costs a look at each page (128 x 128 cells).
  std::vector<TileIndex> ChangedSince(std::uint64_t version) const;

  /// The smallest box of cells that has all known ones.
  CellBox KnownBox() const;
  /// The map as a plain array, of the known box or a box of the caller's.
  OccupancyGrid Grid() const { return Grid(KnownBox()); }
  OccupancyGrid Grid(const CellBox& box) const;
  /// 1 where a transient was removed, else 0; rows from the bottom.
  std::vector<std::uint8_t> Removed(const CellBox& box) const;

  // --- for whoever makes maps

  using Pages = PageGrid<std::shared_ptr<const MapPage>>;
  OccupancyMap(double resolution, std::uint64_t version, Pages pages)
      : resolution_(resolution), version_(version), pages_(std::move(pages)) {}
  const Pages& AllPages() const { return pages_; }

 private:
  double resolution_;
  std::uint64_t version_ = 0;
  Pages pages_;
};

}  // namespace graticule
