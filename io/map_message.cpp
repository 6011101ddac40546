#include "graticule/io/map_message.hpp"

namespace graticule {

std::vector<std::int8_t> MapMessageData(const OccupancyGrid& grid) {
  std::vector<std::int8_t> data;
  data.reserve(grid.cells.size());
  for (const Occupancy cell : grid.cells)
    data.push_back(cell == Occupancy::kUnknown ? -1 : cell == Occupancy::kFree ? 0 : 100);
  return data;
}

}  // namespace graticule
