#pragma once

#include <algorithm>

#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/factor.hpp"

namespace graticule {

/// Where a prior (PoseRole kPrior, kPriorWithOffset) says that its pose is.
inline void PoseFromPrior(bool planar, const FactorView& prior, double* world_from_body) {
  double world_from_sensor[7];
  CopyPose(planar, prior.measurement.data(), world_from_sensor);
  if (PoseRoleOf(prior.type->name) == PoseRole::kPriorWithOffset) {
    double body_from_sensor[7], sensor_from_body[7];
    CopyPose(planar, prior.measurement.data() + 7, body_from_sensor);
    Invert(planar, body_from_sensor, sensor_from_body);
    Compose(planar, world_from_sensor, sensor_from_body, world_from_body);
  } else {
    std::copy_n(world_from_sensor, PoseSize(planar), world_from_body);
  }
}

/// Where a between factor says that one end is, from the other: from a where `from_is_a`.
inline void PoseFromBetween(bool planar, const FactorView& between, bool from_is_a,
                            const double* world_from_known, double* world_from_other) {
  double a_from_b[7];
  CopyPose(planar, between.measurement.data(), a_from_b);
  if (from_is_a) return Compose(planar, world_from_known, a_from_b, world_from_other);
  double b_from_a[7];
  Invert(planar, a_from_b, b_from_a);
  Compose(planar, world_from_known, b_from_a, world_from_other);
}

}  // namespace graticule
