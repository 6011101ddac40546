#pragma once

#include <Eigen/Core>
#include <optional>

#include "graticule/factors/camera_model.hpp"
#include "graticule/io/camera_file.hpp"

namespace graticule {

/// A calibrated camera: rays to pixels and back.  Rays are directions in the camera's frame: x
/// right, y down, z forward.
class Camera {
 public:
  /// Throws Error (kUsage): no such model, wrong number of parameters, not finite, no focal length,
  /// an image without size.
  explicit Camera(CameraIntrinsics intrinsics);

  const CameraIntrinsics& Intrinsics() const { return intrinsics_; }
  const CameraModel& Model() const { return *model_; }
  int Width() const { return intrinsics_.width; }
  int Height() const { return intrinsics_.height; }

  /// Farthest angle from the optical axis [rad] up to which images move outward: beyond it the
  /// polynomial of a lens turns back, and two rays have one pixel.
  double MaxAngle() const { return max_angle_; }

  /// Pixel of a point [any unit] that lies in this direction; none beyond MaxAngle().
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& in_camera) const;
  /// Also the derivatives by the point (2 x 3, row-major) and by the parameters (2 x n), unless
  /// null.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& in_camera, double* by_point,
                                         double* by_parameters) const;

  /// Unit ray whose image is this pixel, to 1e-10 of a radian; none where no ray within
  /// MaxAngle() has its image there.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

 private:
  CameraIntrinsics intrinsics_;
  const CameraModel* model_;
  double max_angle_ = 0;
};

}  // namespace graticule
