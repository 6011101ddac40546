#pragma once

#include "graticule/io/planar_pose.hpp"
#include "graticule/solver/values.hpp"

namespace graticule {

/// A pose of the plane (se2/1) among a graph's values.  Throws Error: an unknown key, or one that
/// is not three numbers.
PlanarPose PlanarPoseAt(const Values& values, const Key& key);

}  // namespace graticule
