// A ROS 2 node that maps as its robot drives: /scan and /odom in, /map out.
#include <cmath>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/io/map_message.hpp"
#include "graticule/problems/mapping/live_map.hpp"
#include "graticule/problems/mapping/planar_values.hpp"
#include "graticule/solver/online.hpp"

using namespace graticule;
using MapMessage = nav_msgs::msg::OccupancyGrid;
using OdometryMessage = nav_msgs::msg::Odometry;
using ScanMessage = sensor_msgs::msg::LaserScan;

struct Mapper : rclcpp::Node {
  Mapper() : Node("graticule_mapper") {
    to_odometry = create_subscription<OdometryMessage>(
        "odom", 50, [this](OdometryMessage::ConstSharedPtr said) {
          const auto& p = said->pose.pose.position;
          const auto& q = said->pose.pose.orientation;
          odom_from_robot = {p.x, p.y, 2 * std::atan2(q.z, q.w)};  // turned about z
        });
    to_scans = create_subscription<ScanMessage>(
        "scan", rclcpp::SensorDataQoS(), [this](ScanMessage::ConstSharedPtr scan) { Take(*scan); });
  }

  void Take(const ScanMessage& scan) {  // a node of the graph every half metre
    const PlanarPose moved = Inverse(odom_at_node) * odom_from_robot;
    if (!keys.empty() && std::hypot(moved.x, moved.y) < 0.5 && std::abs(moved.yaw) < 0.3) return;
    odom_at_node = odom_from_robot;
    const Key key("pose", static_cast<std::uint32_t>(keys.size()));
    PlanarPose guess;
    if (!keys.empty()) guess = PlanarPoseAt(*online.Latest(), keys.back()) * moved;
    online.Add(key, "se2/1", {guess.x, guess.y, guess.yaw});
    // Scan matching (scan_match.hpp) and loop closures (loop_search.hpp) add their factors here.
    if (!keys.empty())
      online.Add(BetweenSe2Factor(keys.back(), key, {moved.x, moved.y, moved.yaw},
                                  Noise::Sigmas({0.05, 0.05, 0.02}), "odometry"));
    online.Update();
    keys.push_back(key);
    // Fourth, from your tf tree: robot_from_laser, where the laser is on the robot.
    const LaserGeometry laser{scan.angle_min, scan.angle_increment, scan.range_max, {}};
    live.AddNode(/*robot=*/0, laser, scan.ranges, guess);
    live.UpdatePoses(*online.Latest(), keys);
    live.Update(/*deadline=*/0.02);
    Publish(live.Map()->Grid(), scan.header);
  }

  void Publish(const OccupancyGrid& grid, const std_msgs::msg::Header& header) {
    MapMessage message;
    message.header = header;
    message.header.frame_id = "map";
    message.info.resolution = static_cast<float>(grid.resolution);
    message.info.width = static_cast<std::uint32_t>(grid.width);
    message.info.height = static_cast<std::uint32_t>(grid.height);
    message.info.origin.position.x = grid.map_from_grid.x;
    message.info.origin.position.y = grid.map_from_grid.y;
    message.data = MapMessageData(grid);
    map->publish(message);
  }

  Online online{Builtins()};
  LiveMap live;
  PlanarPose odom_from_robot, odom_at_node;
  std::vector<Key> keys;  // of the nodes
  rclcpp::Publisher<MapMessage>::SharedPtr map =
      create_publisher<MapMessage>("map", rclcpp::QoS(1).transient_local());
  rclcpp::Subscription<OdometryMessage>::SharedPtr to_odometry;
  rclcpp::Subscription<ScanMessage>::SharedPtr to_scans;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Mapper>());
  rclcpp::shutdown();
}
