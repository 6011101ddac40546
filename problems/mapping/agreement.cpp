#include "graticule/problems/mapping/agreement.hpp"

namespace graticule {
namespace {

void AddTile(const MapTile& tile, const MapTile& reference, MapAgreement* sum) {
  const auto add = [](const CellBits& cells, std::size_t* count) {
    *count += static_cast<std::size_t>(cells.Count());
  };
  const CellBits known = tile.structure | tile.free;
  const CellBits reference_known = reference.structure | reference.free;
  const CellBits different = (tile.structure ^ reference.structure) | (tile.free ^ reference.free);
  add(tile.structure & reference.structure, &sum->structure_both);
  add(tile.structure | reference.structure, &sum->structure_either);
  add(tile.free & reference.free, &sum->free_both);
  add(tile.free | reference.free, &sum->free_either);
  add(reference_known, &sum->known);
  add(reference_known & known, &sum->known_both);
  add(reference_known & different, &sum->different_known);
  add(different, &sum->different);
}

}  // namespace

MapAgreement Agreement(const OccupancyMap& map, const OccupancyMap& reference) {
  MapAgreement sum;
  static const MapTile nothing;
  reference.AllPages().ForEach([&](TileIndex page, const std::shared_ptr<const MapPage>& tiles) {
    if (!tiles) return;
    for (int place = 0; place < kPageTiles; ++place)
      AddTile(map.TileAt(TileOfPage(page, place)), tiles->tiles[place], &sum);
  });
  map.AllPages().ForEach([&](TileIndex page, const std::shared_ptr<const MapPage>& tiles) {
    const auto* other = reference.AllPages().Find(page);
    if (!tiles || (other && *other)) return;
    for (const MapTile& tile : tiles->tiles) AddTile(tile, nothing, &sum);
  });
  return sum;
}

}  // namespace graticule
