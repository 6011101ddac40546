#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/problems/mapping/surface_points.hpp"

namespace graticule {

struct FrontEndOptions {
  double node_distance = 0.3;  ///< m
  double node_turn = 0.25;     ///< rad
  // dead reckoning
  double odometry_sigma_m = 0.1;  // m a metre
  double odometry_sigma_turn_m = 0.03;  // m a rad
  double odometry_sigma_rad = 0.2;      // rad a rad
  double odometry_sigma_m_rad = 0.03;   // rad a metre
  int local_nodes = 12;
  SurfaceOptions surface;
};

struct TrackNode {
  std::size_t scan = 0;
  PlanarPose pose;
  std::vector<SurfacePoint> points;
  Eigen::Matrix3d information;  // of the match with what was before
  double matched = 1;
};

struct Track {
  std::vector<TrackNode> nodes;
  std::vector<PlanarPose> scan_poses;  // of every scan
};

Track FollowScans(const LaserLog& log, const FrontEndOptions& options);

}  // namespace graticule
