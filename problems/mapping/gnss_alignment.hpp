#pragma once

#include <cstddef>
#include <vector>

#include "graticule/io/planar_pose.hpp"

namespace graticule {

/// A point of a map, and where on the ground it is said to be.
struct GroundPoint {
  double x = 0, y = 0;         ///< m, in the map
  double east = 0, north = 0;  ///< m
  double sigma = 1;            ///< m
};

/// Where a map lies on the ground.
struct GroundAlignment {
  PlanarPose ground_from_map;
  double sigma_yaw = 0;               ///< rad
  double sigma = 0;                   ///< m, at the middle of the points
  double middle_x = 0, middle_y = 0;  ///< m, in the map
  std::size_t agreeing = 0;           ///< points within three deviations
};

/// Lays a map onto the ground: the turn and shift of pairs of points that are far apart, the one
/// that most points agree with, then weighted least squares in closed form (Horn 1987, in the
/// plane), points weighed by a Cauchy loss.  Up to half of the points may lie anywhere.
/// Deterministic.  Needs two points at two places; `sigma_yaw` is infinite where it has not.
GroundAlignment AlignToGround(const std::vector<GroundPoint>& points);

}  // namespace graticule
