#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "graticule/io/laser_log.hpp"

namespace graticule {

struct BagLaserOptions {
  /// Empty: `/scan`, else the only sensor_msgs/LaserScan.
  std::string scan_topic;
  /// nav_msgs/Odometry.  Empty: `/odom`, else the only one; where there is none, the transforms
  /// from the frame `odom` to the robot.
  std::string odometry_topic;
  /// robot_from_laser, instead of what the bag's transforms say, or do not say.
  std::optional<PlanarPose> laser_offset;
};

struct BagLaserSummary {
  std::string scan_topic, odometry;  ///< what was read: "/odom", "tf odom -> base_link"
  std::size_t scans = 0;
  std::size_t without_odometry = 0;  ///< scans before the first or after the last of it: left out
  /// robot_from_laser, as the bag's transforms say.  Empty: they do not say.
  std::optional<PlanarPose> told_laser_offset;
};

/// Reads the scans of a ROS bag and appends them to `log` as a robot of their own (robot1, robot2,
/// ...), with the odometry at their header's times, interpolated.  The laser is on its robot where
/// /tf and /tf_static say, else at its centre; one that is mounted upside down is turned.  Readings
/// that are not a number, infinite or outside of the scan's limits saw nothing.
///
/// Throws Error "path: ...": as BagReader does; no scans, no odometry, several topics to choose
/// from (with a list of what there is), a message that is damaged, times that go back, a laser that
/// does not look around a vertical axis.
BagLaserSummary ReadBagLaser(const std::string& path, const BagLaserOptions& options,
                             LaserLog* log);

}  // namespace graticule
