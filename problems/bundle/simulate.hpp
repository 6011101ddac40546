#pragma once

#include <cstdint>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// Cameras on a ring around a cloud of points, all looking at its middle.
struct RingOptions {
  int cameras = 10;
  int points = 200;
  double ring_m = 10;  ///< radius of the ring
  double cloud_m = 2;  ///< half the side of the cube that the points fill
  double focal_px = 800;
  double visible = 0.7;  ///< chance that a camera sees a point; each point is seen by two at least
  double pixel_sigma = 0.5;
  /// How far off the initial values are.
  double camera_sigma_rad = 0.01;
  double camera_sigma_m = 0.1;
  double point_sigma_m = 0.1;
  std::uint64_t seed = 1;
};

struct SimulatedBundle {
  Graph graph;
  Values truth;
};

/// A bundle adjustment problem with truth: `camera:i` (bal_camera/1), `point:j` (point3/1),
/// bal_reprojection/1 with source "image".  The first two cameras are fixed at the truth, which
/// leaves no gauge.  At the truth the residual is the noise itself.  Same options, same digits.
/// Throws Error (kUsage) where an option makes no sense.
SimulatedBundle SimulateRing(const Registry& types, const RingOptions& options = {});

}  // namespace graticule
