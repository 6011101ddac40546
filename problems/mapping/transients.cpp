#include "graticule/problems/mapping/transients.hpp"

namespace graticule {

OccupancyGrid TransientsOf(const OccupancyMap& map) {
  const CellBox box = map.KnownBox();
  OccupancyGrid layer = map.Grid(box);
  const std::vector<std::uint8_t> removed = map.Removed(box);
  for (std::size_t i = 0; i < layer.cells.size(); ++i) {
    if (layer.cells[i] == Occupancy::kUnknown) continue;
    layer.cells[i] = removed[i] ? Occupancy::kStructure : Occupancy::kFree;
  }
  return layer;
}

}  // namespace graticule
