#pragma once

#include <cmath>

#include "graticule/factors/lie.hpp"
#include "graticule/solver/rotation.hpp"

namespace graticule {

/// Poses as the graph stores them: [x y yaw] in the plane, [x y z qx qy qz qw] in space.  `planar`
/// says which.  Outputs may not overlap inputs.

inline int PoseSize(bool planar) { return planar ? 3 : 7; }

/// A pose as a file carries it (six digits of a quaternion, any yaw), brought onto its manifold.
inline void CopyPose(bool planar, const double* given, double* pose) {
  for (int i = 0; i < PoseSize(planar); ++i) pose[i] = given[i];
  if (planar) {
    pose[2] = WrapAngle(pose[2]);
    return;
  }
  double* q = pose + 3;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) q[i] /= norm;
}

/// The point, given in a, in the world.
inline void TransformPoint(bool planar, const double* world_from_a, const double* in_a,
                           double* in_world) {
  if (planar) {
    const double c = std::cos(world_from_a[2]), s = std::sin(world_from_a[2]);
    in_world[0] = world_from_a[0] + c * in_a[0] - s * in_a[1];
    in_world[1] = world_from_a[1] + s * in_a[0] + c * in_a[1];
  } else {
    QuaternionRotate(world_from_a + 3, in_a, in_world);
    for (int i = 0; i < 3; ++i) in_world[i] += world_from_a[i];
  }
}

/// world_from_b = world_from_a * a_from_b.
inline void Compose(bool planar, const double* world_from_a, const double* a_from_b,
                    double* world_from_b) {
  TransformPoint(planar, world_from_a, a_from_b, world_from_b);
  if (planar) {
    world_from_b[2] = WrapAngle(world_from_a[2] + a_from_b[2]);
    return;
  }
  double* q = world_from_b + 3;
  QuaternionProduct(world_from_a + 3, a_from_b + 3, q);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) q[i] /= norm;
}

/// b_from_a = inverse(a_from_b).
inline void Invert(bool planar, const double* a_from_b, double* b_from_a) {
  if (planar) {
    const double c = std::cos(a_from_b[2]), s = std::sin(a_from_b[2]);
    b_from_a[0] = -c * a_from_b[0] - s * a_from_b[1];
    b_from_a[1] = s * a_from_b[0] - c * a_from_b[1];
    b_from_a[2] = WrapAngle(-a_from_b[2]);
    return;
  }
  for (int i = 0; i < 3; ++i) b_from_a[3 + i] = -a_from_b[3 + i];
  b_from_a[6] = a_from_b[6];
  const double back[3] = {-a_from_b[0], -a_from_b[1], -a_from_b[2]};
  QuaternionRotate(b_from_a + 3, back, b_from_a);
}

/// a_from_b = inverse(world_from_a) * world_from_b.
inline void Between(bool planar, const double* world_from_a, const double* world_from_b,
                    double* a_from_b) {
  double a_from_world[7];
  Invert(planar, world_from_a, a_from_world);
  Compose(planar, a_from_world, world_from_b, a_from_b);
}

}  // namespace graticule
