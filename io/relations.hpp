#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/planar_pose.hpp"

namespace graticule {

/// Where a robot was at one time, seen from where it was at another.
struct PoseRelation {
  double time_a = 0, time_b = 0;  ///< s
  PlanarPose a_from_b;
};

/// Reads the ground truth of a planar SLAM benchmark (R. Kuemmerle et al., "On measuring the
/// accuracy of SLAM algorithms", Autonomous Robots 27, 2009): lines `t1 t2 x y z roll pitch yaw`,
/// `#` begins a comment.  Throws Error "name:line:column: ..."; no relation at all.
std::vector<PoseRelation> ParseRelations(std::string_view text, const std::string& name);

}  // namespace graticule
