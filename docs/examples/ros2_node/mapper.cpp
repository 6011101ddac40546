// A ROS 2 node that maps as its robot drives: /scan and /odom in, /map out.
#include <cmath>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/problems/mapping/live_map.hpp"
#include "graticule/solver/online.hpp"

using namespace graticule;

class Mapper : public rclcpp::Node {
 public:
  Mapper() : Node("graticule_mapper"), online_(Builtins()) {
    map_ = create_publisher<nav_msgs::msg::OccupancyGrid>("map", rclcpp::QoS(1).transient_local());
    odometry_ = create_subscription<nav_msgs::msg::Odometry>(
        "odom", 50, [this](nav_msgs::msg::Odometry::ConstSharedPtr message) {
          const auto& p = message->pose.pose.position;
          const auto& q = message->pose.pose.orientation;  // turned about z
          odom_from_robot_ = {p.x, p.y, 2 * std::atan2(q.z, q.w)};
        });
    scans_ = create_subscription<sensor_msgs::msg::LaserScan>(
        "scan", rclcpp::SensorDataQoS(),
        [this](sensor_msgs::msg::LaserScan::ConstSharedPtr message) { Take(*message); });
  }

 private:
  void Take(const sensor_msgs::msg::LaserScan& scan) {
    const PlanarPose moved = Inverse(odom_at_node_) * odom_from_robot_;
    if (nodes_ > 0 && std::hypot(moved.x, moved.y) < 0.5 && std::abs(moved.yaw) < 0.3) return;
    odom_at_node_ = odom_from_robot_;
    // A node every half metre, guessed from the one before.  The first is held.
    const Key key("pose", nodes_);
    const PlanarPose guess = nodes_ > 0 ? PoseOf(nodes_ - 1) * moved : PlanarPose{};
    online_.Add(key, "se2/1", {guess.x, guess.y, guess.yaw});
    if (nodes_ > 0)
      online_.Add(BetweenSe2Factor(Key("pose", nodes_ - 1), key, {moved.x, moved.y, moved.yaw},
                                   Noise::Sigmas({0.05, 0.05, 0.02}), "odometry"));
    // Your scan matching and loop closures add their BetweenSe2Factor here, with a loss
    // (problems/mapping/scan_match.hpp, loop_search.hpp).
    online_.Update();
    LaserGeometry laser;  // where it is on the robot: robot_from_laser, from your tf tree
    laser.first_angle = scan.angle_min;
    laser.step = scan.angle_increment;
    laser.max_range = scan.range_max;
    live_.AddNode(/*robot=*/0, laser, {scan.ranges.data(), scan.ranges.size()}, guess);
    ++nodes_;
    for (std::uint32_t node = 0; node < nodes_; ++node) live_.UpdatePose(node, PoseOf(node));
    live_.Update(/*deadline=*/0.02);
    Publish(scan.header.stamp);
  }

  PlanarPose PoseOf(std::uint32_t node) const {
    const auto pose = online_.Latest()->At(Key("pose", node));
    return {pose[0], pose[1], pose[2]};
  }

  template <class Stamp>
  void Publish(const Stamp& stamp) {
    const OccupancyGrid grid = live_.Map()->Grid();
    nav_msgs::msg::OccupancyGrid message;
    message.header.stamp = stamp;
    message.header.frame_id = "map";
    message.info.resolution = static_cast<float>(grid.resolution);
    message.info.width = static_cast<std::uint32_t>(grid.width);
    message.info.height = static_cast<std::uint32_t>(grid.height);
    message.info.origin.position.x = grid.map_from_grid.x;
    message.info.origin.position.y = grid.map_from_grid.y;
    message.info.origin.orientation.w = 1;
    for (const Occupancy cell : grid.cells)
      message.data.push_back(cell == Occupancy::kUnknown ? -1 : cell == Occupancy::kFree ? 0 : 100);
    map_->publish(message);
  }

  Online online_;
  LiveMap live_;
  PlanarPose odom_from_robot_, odom_at_node_;
  std::uint32_t nodes_ = 0;
  rclcpp::Publisher<nav_msgs::msg::OccupancyGrid>::SharedPtr map_;
  rclcpp::Subscription<nav_msgs::msg::Odometry>::SharedPtr odometry_;
  rclcpp::Subscription<sensor_msgs::msg::LaserScan>::SharedPtr scans_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Mapper>());
  rclcpp::shutdown();
  return 0;
}
