#pragma once

#include <cstdint>
#include <vector>

#include "graticule/io/occupancy.hpp"

namespace graticule {

/// The cells as the member `data` of ROS' nav_msgs/OccupancyGrid: -1 unknown, 0 free, 100
/// structure; row by row, the lowest first, as they are in the grid.
std::vector<std::int8_t> MapMessageData(const OccupancyGrid& grid);

}  // namespace graticule
