#pragma once

#include <vector>

#include "odometry.hpp"

namespace nav_msgs::msg {
struct MapMetaData {
  float resolution = 0;
  std::uint32_t width = 0, height = 0;
  geometry_msgs::msg::Pose origin;
};
struct OccupancyGrid {
  std_msgs::msg::Header header;
  MapMetaData info;
  std::vector<std::int8_t> data;
};
}  // namespace nav_msgs::msg
