#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/problems/mapping/front_end.hpp"

namespace graticule {

/// A scan that is a node.
struct TrackNode {
  std::size_t scan = 0;  ///< into LaserLog::scans
  std::uint32_t robot = 0;
  bool is_first = false;     ///< of its robot
  double travelled = 0;      ///< m, since the robot's first
  PlanarPose pose;           ///< where it is taken to be
  PlanarPose odometry_step;  ///< from the node before to this
  PlanarPose match_step;     ///< the same, as matched
  /// Of match_step, in this node's frame, per unit variance of a residual.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  /// Share of points that were matched: the least of the scans since the node before.
  double matched = 1;
  std::vector<SurfacePoint> points;  ///< in the robot's frame
};

/// A robot's way, by matching each scan against the nodes before it.
struct Track {
  std::vector<TrackNode> nodes;
  std::vector<std::size_t> scans;      ///< the robot's, into LaserLog::scans
  std::vector<PlanarPose> scan_poses;  ///< of each of these, in the frame of the first
};

/// Standard deviations of dead reckoning over a step.
struct MotionSigmas {
  double sigma = 0, sigma_yaw = 0;
};
MotionSigmas SigmasOf(const PlanarPose& step, const FrontEndOptions& options);

/// Follows a robot's scans.  Correlative matching near where dead reckoning puts a scan, which also
/// counts as a prior (corridors), then refinement on points.  About half a millisecond a scan.
Track FollowScans(const LaserLog& log, std::uint32_t robot, const FrontEndOptions& options,
                  const std::function<void(double)>& progress = {});

}  // namespace graticule
