#include "graticule/problems/mapping/occupancy_map.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

const MapTile kEmpty;

template <class F>
void ForEachTile(const OccupancyMap& map, F f) {
  map.AllPages().ForEach([&f](TileIndex page, const std::shared_ptr<const MapPage>& tiles) {
    if (!tiles) return;
    for (int place = 0; place < kPageTiles; ++place)
      if (tiles->changed_in[place]) f(TileOfPage(page, place), tiles->tiles[place]);
  });
}

// Calls f(index into an array of the box, bits' cell) for the set cells inside.
template <class F>
void ForEachIn(const CellBox& box, TileIndex tile, const CellBits& bits, F f) {
  ForEachCell(bits, [&](int column, int row) {
    const std::int32_t x = kTileSide * tile.x + column, y = kTileSide * tile.y + row;
    if (box.Has(x, y))
      f(static_cast<std::size_t>(y - box.bottom) * static_cast<std::size_t>(box.width) +
        static_cast<std::size_t>(x - box.left));
  });
}

std::size_t Cells(const CellBox& box) {
  return static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height);
}

}  // namespace

Occupancy OccupancyMap::AtPlace(double x, double y) const {
  const double column = std::floor(x / resolution_), row = std::floor(y / resolution_);
  constexpr double kFar = 1 << 30;
  if (!(std::abs(column) < kFar && std::abs(row) < kFar)) return Occupancy::kUnknown;
  return At(static_cast<std::int32_t>(column), static_cast<std::int32_t>(row));
}

const MapTile& OccupancyMap::TileAt(TileIndex tile) const {
  const std::shared_ptr<const MapPage>* page = pages_.Find(PageOf(tile));
  return page && *page ? (*page)->tiles[PlaceInPage(tile)] : kEmpty;
}

std::vector<TileIndex> OccupancyMap::ChangedSince(std::uint64_t version) const {
  std::vector<TileIndex> changed;
  pages_.ForEach([&](TileIndex page, const std::shared_ptr<const MapPage>& tiles) {
    if (!tiles || tiles->newest <= version) return;
    for (int place = 0; place < kPageTiles; ++place)
      if (tiles->changed_in[place] > version) changed.push_back(TileOfPage(page, place));
  });
  std::sort(changed.begin(), changed.end());
  return changed;
}

CellBox OccupancyMap::KnownBox() const {
  std::int32_t left = INT32_MAX, bottom = INT32_MAX, right = INT32_MIN, top = INT32_MIN;
  ForEachTile(*this, [&](TileIndex index, const MapTile& tile) {
    const CellBits known = tile.structure | tile.free;
    if (!known.Any()) return;
    const std::int32_t x = kTileSide * index.x, y = kTileSide * index.y;
    if (x >= left && y >= bottom && x + kTileSide - 1 <= right && y + kTileSide - 1 <= top) return;
    ForEachCell(known, [&](int column, int row) {
      left = std::min(left, x + column);
      right = std::max(right, x + column);
      bottom = std::min(bottom, y + row);
      top = std::max(top, y + row);
    });
  });
  if (left > right) return {};
  return {left, bottom, right - left + 1, top - bottom + 1};
}

OccupancyGrid OccupancyMap::Grid(const CellBox& box) const {
  OccupancyGrid grid;
  grid.resolution = resolution_;
  grid.map_from_grid = {box.left * resolution_, box.bottom * resolution_, 0};
  grid.width = static_cast<std::size_t>(box.width);
  grid.height = static_cast<std::size_t>(box.height);
  grid.cells.assign(Cells(box), Occupancy::kUnknown);
  ForEachTile(*this, [&](TileIndex index, const MapTile& tile) {
    ForEachIn(box, index, tile.structure,
              [&](std::size_t cell) { grid.cells[cell] = Occupancy::kStructure; });
    ForEachIn(box, index, tile.free,
              [&](std::size_t cell) { grid.cells[cell] = Occupancy::kFree; });
  });
  return grid;
}

std::vector<std::uint8_t> OccupancyMap::Removed(const CellBox& box) const {
  std::vector<std::uint8_t> removed(Cells(box), 0);
  ForEachTile(*this, [&](TileIndex index, const MapTile& tile) {
    ForEachIn(box, index, tile.removed, [&](std::size_t cell) { removed[cell] = 1; });
  });
  return removed;
}

}  // namespace graticule
