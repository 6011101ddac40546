#pragma once

#include <vector>

#include "../../nav_msgs/msg/odometry.hpp"

namespace sensor_msgs::msg {
struct LaserScan {
  using ConstSharedPtr = std::shared_ptr<const LaserScan>;
  std_msgs::msg::Header header;
  float angle_min = 0, angle_max = 0, angle_increment = 0, range_min = 0, range_max = 0;
  std::vector<float> ranges;
};
}  // namespace sensor_msgs::msg
