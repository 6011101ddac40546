// The node of docs/examples/ros2_node, against stubs of ROS 2's headers: it compiles with the
// public library alone, and maps a room.  Not shown: that it builds and runs with ROS 2 itself.

#include <gtest/gtest.h>

#define main mapper_main
#include "../../docs/examples/ros2_node/mapper.cpp"
#undef main

namespace {

// From (x, y) to the walls of a room of 6 x 4 m about the origin.
double RangeToWall(double x, double y, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const double along_x = c > 0 ? (3 - x) / c : c < 0 ? (-3 - x) / c : HUGE_VAL;
  const double along_y = s > 0 ? (2 - y) / s : s < 0 ? (-2 - y) / s : HUGE_VAL;
  return std::min(along_x, along_y);
}

TEST(Ros2Node, MapsARoom) {
  Mapper node;
  for (int step = 0; step <= 20; ++step) {
    const double x = 0.1 * step, yaw = 0.05 * step;
    nav_msgs::msg::Odometry odometry;
    odometry.pose.pose.position.x = x;
    odometry.pose.pose.orientation.z = std::sin(yaw / 2);
    odometry.pose.pose.orientation.w = std::cos(yaw / 2);
    node.Deliver("odom", odometry);
    sensor_msgs::msg::LaserScan scan;
    scan.header.stamp.sec = step;
    scan.angle_min = -3.14f;
    scan.angle_increment = 0.02f;
    scan.range_max = 20;
    for (int i = 0; i < 315; ++i)
      scan.ranges.push_back(
          static_cast<float>(RangeToWall(x, 0, yaw + scan.angle_min + i * scan.angle_increment)));
    node.Deliver("scan", scan);
  }
  const auto& map = node.Published<nav_msgs::msg::OccupancyGrid>("map");
  EXPECT_EQ(map.header.frame_id, "map");
  ASSERT_EQ(map.data.size(), map.info.width * map.info.height);
  const auto at = [&](double x, double y) {
    const auto column = static_cast<std::size_t>((x - map.info.origin.position.x) /
                                                 static_cast<double>(map.info.resolution));
    const auto row = static_cast<std::size_t>((y - map.info.origin.position.y) /
                                              static_cast<double>(map.info.resolution));
    return static_cast<int>(map.data.at(row * map.info.width + column));
  };
  for (double x = -2.5; x <= 2.5; x += 0.5)
    for (double y = -1.5; y <= 1.5; y += 0.5) EXPECT_EQ(at(x, y), 0) << x << ' ' << y;
  int walls = 0;
  for (double y = -1.5; y <= 1.5; y += 0.1) walls += at(3.02, y) == 100 || at(2.98, y) == 100;
  EXPECT_GT(walls, 25);
}

}  // namespace
