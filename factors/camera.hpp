#pragma once

#include <Eigen/Geometry>

#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

/// A point of the world projects where the camera saw it.
/// Residual [px, px]; zero when they agree.  Model of Bundle Adjustment in the Large (Agarwal et
/// al., ECCV 2010): P = R X + t, p = -P.xy / P.z (the camera looks along -z, v is up, the origin is
/// the image's centre), pixel = f (1 + k1 |p|^2 + k2 |p|^4) p.
/// A point exactly in the camera's plane cannot be evaluated.  The gauge is free in seven
/// parameters, scale among them, so it is not called relative: the solver's anchors do not fit it.
struct BalReprojection {
  static constexpr const char* kName = "bal_reprojection/1";
  static constexpr const char* kSchema = "camera:bal_camera/1 point:point3/1 | u:px v:px";
  static constexpr const char* kSummary =
      "point seen by a camera of Bundle Adjustment in the Large";

  double u_px, v_px;

  explicit BalReprojection(Measurement m) : u_px(m[0]), v_px(m[1]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double* camera = blocks[0];
    const Eigen::Vector3d w(camera), point(blocks[1]);
    const Coefficients c(w.squaredNorm());
    const Eigen::Vector3d across = w.cross(point);
    const Eigen::Vector3d turned = point + c.sine * across + c.versine * w.cross(across);
    const Eigen::Vector3d in_camera = turned + Eigen::Vector3d(camera + 3);
    if (in_camera.z() == 0) return false;

    const double inverse_depth = -1 / in_camera.z();
    const double x = in_camera.x() * inverse_depth, y = in_camera.y() * inverse_depth;
    const double f = camera[6], k1 = camera[7], k2 = camera[8];
    const double n = x * x + y * y;
    const double distortion = 1 + n * (k1 + n * k2);
    residual[0] = f * distortion * x - u_px;
    residual[1] = f * distortion * y - v_px;
    if (!jacobians) return true;

    // d(pixel)/d(in_camera): through x, y, with d(x, y)/d(in_camera) = inverse_depth [1 0 x; 0 1 y]
    const double slope = 2 * f * (k1 + 2 * k2 * n), scale = f * distortion;
    const double xx = inverse_depth * (scale + slope * x * x), xy = inverse_depth * slope * x * y;
    const double yy = inverse_depth * (scale + slope * y * y);
    RowMajor<2, 3> by_position;
    by_position << xx, xy, xx * x + xy * y, xy, yy, xy * x + yy * y;

    const RowMajor<3, 3> skew = Skew(w), skew_squared = skew * skew;
    if (jacobians[0]) {
      JacobianMap<2, 9> j(jacobians[0]);
      // d(R X)/dw = -[R X] (left Jacobian of w)
      const RowMajor<3, 3> left =
          RowMajor<3, 3>::Identity() + c.versine * skew + c.cubic * skew_squared;
      const RowMajor<2, 3> by_turn = by_position * Skew(turned);
      j.leftCols<3>().noalias() = -by_turn * left;
      j.middleCols<3>(3) = by_position;
      j.rightCols<3>() << distortion * x, f * n * x, f * n * n * x,  //
          distortion * y, f * n * y, f * n * n * y;
    }
    if (jacobians[1]) {
      const RowMajor<3, 3> r =
          RowMajor<3, 3>::Identity() + c.sine * skew + c.versine * skew_squared;
      JacobianMap<2, 3>(jacobians[1]).noalias() = by_position * r;
    }
    return true;
  }

 private:
  /// sin(a)/a, (1 - cos(a))/a^2, (a - sin(a))/a^3; below 0.01 rad by series good to 1e-13.
  struct Coefficients {
    double sine, versine, cubic;
    explicit Coefficients(double squared) {
      if (squared < 1e-4) {
        sine = 1 - squared / 6 * (1 - squared / 20);
        versine = 0.5 - squared / 24 * (1 - squared / 30);
        cubic = 1.0 / 6 - squared / 120 * (1 - squared / 42);
        return;
      }
      const double angle = std::sqrt(squared);
      const double s = std::sin(angle / 2), sin_angle = 2 * s * std::cos(angle / 2);
      sine = sin_angle / angle;
      versine = 2 * s * s / squared;
      cubic = (angle - sin_angle) / (squared * angle);
    }
  };
};

}  // namespace graticule
