#include "graticule/io/bag_laser.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "graticule/io/bag.hpp"
#include "graticule/io/ros_messages.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr char kScan[] = "sensor_msgs/LaserScan", kOdometry[] = "nav_msgs/Odometry";
const std::vector<std::string> kTransforms = {"tf2_msgs/TFMessage", "tf/tfMessage"};

// A scan may be stamped a little before the first odometry, or after the last.
constexpr double kSlack_s = 0.1;

struct Stamped {
  double time;
  PlanarPose odom_from_robot;
};

Eigen::Isometry3d IsometryOf(const std::array<double, 7>& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]).toRotationMatrix();
  isometry.translation() = Eigen::Vector3d(pose[0], pose[1], pose[2]);
  return isometry;
}

PlanarPose PlanarOf(const Eigen::Isometry3d& pose) {
  return {pose.translation().x(), pose.translation().y(),
          std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))};
}

class Reader {
 public:
  Reader(const std::string& path, const BagLaserOptions& options)
      : path_(path), options_(options), topics_(BagTopics(path)) {
    scan_topic_ = TopicOf(path, topics_, {kScan}, options.scan_topic, "/scan", "--scan-topic");
    if (scan_topic_.empty()) throw Error(path + ": has no " + kScan + ListOf(topics_));
    odometry_topic_ =
        TopicOf(path, topics_, {kOdometry}, options.odometry_topic, "/odom", "--odom-topic");
  }

  BagLaserSummary Read(LaserLog* log) {
    ReadMessages();
    if (odometry_.empty())
      throw Error(path_ + ": has no odometry: neither " + kOdometry +
                  " nor transforms from the frame odom" + ListOf(topics_));
    std::stable_sort(odometry_.begin(), odometry_.end(),
                     [](const Stamped& a, const Stamped& b) { return a.time < b.time; });
    BagLaserSummary summary;
    summary.scan_topic = scan_topic_;
    summary.odometry = odometry_topic_.empty() ? "tf odom -> " + robot_frame_ : odometry_topic_;
    bool is_upside_down = false;
    summary.told_laser_offset = ToldOffset(&is_upside_down);
    Append(options_.laser_offset.value_or(summary.told_laser_offset.value_or(PlanarPose{})),
           is_upside_down, log, &summary);
    if (summary.scans == 0)
      throw Error(path_ + ": none of its scans is of a time when there is odometry");
    return summary;
  }

 private:
  void ReadMessages() {
    BagReader reader(path_);
    BagMessage message;
    while (reader.Next(&message)) {
      const BagConnection& from = reader.Connections()[message.connection];
      try {
        if (from.topic == scan_topic_ && from.type == kScan)
          scans_.push_back(ParseRosLaserScan(message.data));
        else if (from.topic == odometry_topic_ && from.type == kOdometry)
          AddOdometry(ParseRosOdometry(message.data));
        else if (std::count(kTransforms.begin(), kTransforms.end(), from.type) > 0)
          for (const RosTransform& transform : ParseRosTransforms(message.data))
            AddTransform(transform);
      } catch (const Error& error) {
        throw Error(path_ + ": " + from.topic + ": " + error.what());
      }
    }
  }

  void AddOdometry(const RosTransform& odometry) {
    robot_frame_ = odometry.child;
    odometry_.push_back(
        {odometry.header.stamp_s, PlanarOf(IsometryOf(odometry.parent_from_child))});
  }

  void AddTransform(const RosTransform& transform) {
    if (odometry_topic_.empty() && transform.header.frame == "odom") {
      AddOdometry(transform);
      return;
    }
    parents_[transform.child] = {transform.header.frame, IsometryOf(transform.parent_from_child)};
  }

  // Up the tree of frames, from the laser to the robot.
  std::optional<PlanarPose> ToldOffset(bool* is_upside_down) const {
    Eigen::Isometry3d robot_from_laser = Eigen::Isometry3d::Identity();
    std::string frame = scans_.empty() ? "" : scans_.front().header.frame;
    std::set<std::string> seen;
    while (frame != robot_frame_) {
      const auto parent = parents_.find(frame);
      if (parent == parents_.end() || !seen.insert(frame).second) return std::nullopt;
      robot_from_laser = parent->second.second * robot_from_laser;
      frame = parent->second.first;
    }
    const double up = robot_from_laser.linear()(2, 2);
    if (std::abs(up) < 0.9)
      throw Error(path_ + ": " + scan_topic_ +
                  ": by the bag's transforms this laser does not look around a vertical axis");
    *is_upside_down = up < 0;
    return PlanarOf(robot_from_laser);
  }

  std::optional<PlanarPose> OdometryAt(double time) const {
    const auto after =
        std::lower_bound(odometry_.begin(), odometry_.end(), time,
                         [](const Stamped& pose, double stamp) { return pose.time < stamp; });
    if (after == odometry_.end())
      return time - odometry_.back().time <= kSlack_s
                 ? std::optional(odometry_.back().odom_from_robot)
                 : std::nullopt;
    if (after == odometry_.begin())
      return after->time - time <= kSlack_s ? std::optional(after->odom_from_robot) : std::nullopt;
    const Stamped& before = *(after - 1);
    return Interpolated(before.odom_from_robot, after->odom_from_robot,
                        (time - before.time) / (after->time - before.time));
  }

  static LaserGeometry GeometryOf(const RosLaserScan& scan, const PlanarPose& offset, bool turned) {
    LaserGeometry geometry;
    geometry.first_angle = scan.angle_min;
    geometry.step = scan.angle_increment;
    // Beams are from the right to the left.
    if (turned) {
      geometry.first_angle *= -1;
      geometry.step *= -1;
    }
    if (geometry.step < 0) {
      geometry.first_angle += geometry.step * (static_cast<double>(scan.ranges.size()) - 1);
      geometry.step *= -1;
    }
    geometry.max_range = scan.range_max;
    geometry.robot_from_laser = offset;
    return geometry;
  }

  void Append(const PlanarPose& offset, bool is_upside_down, LaserLog* log,
              BagLaserSummary* summary) const {
    const auto robot = static_cast<std::uint32_t>(log->robots.size());
    log->robots.push_back("robot" + std::to_string(robot + 1));
    std::map<std::array<double, 4>, std::uint32_t> known;  // geometries
    double last = -HUGE_VAL;
    for (const RosLaserScan& from : scans_) {
      const double time = from.header.stamp_s;
      if (time < last) throw Error(path_ + ": " + scan_topic_ + ": its scans' times go back");
      last = time;
      const auto odometry = OdometryAt(time);
      if (!odometry) {
        ++summary->without_odometry;
        continue;
      }
      const auto [place, is_new] =
          known.try_emplace({from.angle_min, from.angle_increment, from.range_max,
                             static_cast<double>(from.ranges.size())},
                            static_cast<std::uint32_t>(log->geometries.size()));
      if (is_new) log->geometries.push_back(GeometryOf(from, offset, is_upside_down));
      LaserScan scan;
      scan.time = time;
      scan.robot = robot;
      scan.geometry = place->second;
      scan.odom_from_robot = *odometry;
      scan.first_range = log->ranges.size();
      scan.beams = static_cast<std::uint32_t>(from.ranges.size());
      for (const float range : from.ranges) {
        const bool is_seen =
            std::isfinite(range) && range >= from.range_min && range < from.range_max;
        log->ranges.push_back(is_seen ? range : static_cast<float>(from.range_max));
      }
      if ((from.angle_increment < 0) != is_upside_down)
        std::reverse(log->ranges.begin() + static_cast<std::ptrdiff_t>(scan.first_range),
                     log->ranges.end());
      log->scans.push_back(scan);
      ++summary->scans;
    }
  }

  const std::string& path_;
  const BagLaserOptions& options_;
  std::vector<BagConnection> topics_;
  std::string scan_topic_, odometry_topic_, robot_frame_;
  std::vector<RosLaserScan> scans_;
  std::vector<Stamped> odometry_;
  /// A frame's parent, and where it is in it, as it was said last.
  std::map<std::string, std::pair<std::string, Eigen::Isometry3d>> parents_;
};

}  // namespace

BagLaserSummary ReadBagLaser(const std::string& path, const BagLaserOptions& options,
                             LaserLog* log) {
  return Reader(path, options).Read(log);
}

}  // namespace graticule
