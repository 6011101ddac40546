#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "graticule/problems/calibration/camera.hpp"

namespace graticule {

/// Corners of one view: where they are on the target [m], and where they were seen [px].
struct CornerPairs {
  std::vector<Eigen::Vector3d> in_target;
  std::vector<Eigen::Vector2d> pixels;
};

/// Where a flat target is, from the rays of its corners: a homography from the target's plane to
/// the rays (direct linear transform, Hartley and Zisserman, Multiple View Geometry, algorithm
/// 4.2, with cross products in place of pixels, so that rays behind the camera's plane count as
/// any), and the rotation nearest to it.  Heights of the corners are taken as zero.  None with
/// fewer than four corners, or where they lie on a line.
std::optional<Eigen::Isometry3d> PoseFromRays(const std::vector<Eigen::Vector3d>& in_target,
                                              const std::vector<Eigen::Vector3d>& rays_in_camera);

/// A target's pose, and how well it explains a view.
struct TargetPose {
  Eigen::Isometry3d camera_from_target;
  double rms_px = 0;  ///< of the distances; corners without an image count as `kFarOff`
  static constexpr double kFarOff = 1000;  ///< px
};

/// The pose of least reprojection error near a start, the camera as given: Gauss-Newton with
/// damping, corners beyond `huber_px` counted by their distance rather than its square.
TargetPose RefineTargetPose(const Camera& camera, const CornerPairs& corners,
                            const Eigen::Isometry3d& start, double huber_px, int iterations = 20);

/// Both of the above, and from the mirrored tilt too: a small flat target has two poses that are
/// nearly alike.  None where too few pixels have rays.
std::optional<TargetPose> FindTargetPose(const Camera& camera, const CornerPairs& corners,
                                         double huber_px, int iterations = 20);

}  // namespace graticule
