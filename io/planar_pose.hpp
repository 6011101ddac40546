#pragma once

#include <cmath>

namespace graticule {

/// Where a frame b lies in a frame a of the plane: a_from_b.
struct PlanarPose {
  double x = 0, y = 0;  ///< m
  double yaw = 0;       ///< rad

  /// A point given in b, in a.
  void Transform(double x_in_b, double y_in_b, double* x_in_a, double* y_in_a) const {
    const double c = std::cos(yaw), s = std::sin(yaw);
    *x_in_a = x + c * x_in_b - s * y_in_b;
    *y_in_a = y + s * x_in_b + c * y_in_b;
  }
};

/// In (-pi, pi].
inline double WrappedAngle(double angle) { return std::atan2(std::sin(angle), std::cos(angle)); }

/// a_from_c = a_from_b * b_from_c.
inline PlanarPose operator*(const PlanarPose& a_from_b, const PlanarPose& b_from_c) {
  PlanarPose product;
  a_from_b.Transform(b_from_c.x, b_from_c.y, &product.x, &product.y);
  product.yaw = WrappedAngle(a_from_b.yaw + b_from_c.yaw);
  return product;
}

/// b_from_a.
inline PlanarPose Inverse(const PlanarPose& a_from_b) {
  const double c = std::cos(a_from_b.yaw), s = std::sin(a_from_b.yaw);
  return {-c * a_from_b.x - s * a_from_b.y, s * a_from_b.x - c * a_from_b.y,
          WrappedAngle(-a_from_b.yaw)};
}

/// Between two poses, `part` of the way from the first (0) to the second (1), turning the shorter
/// way.
inline PlanarPose Interpolated(const PlanarPose& from, const PlanarPose& to, double part) {
  return {from.x + part * (to.x - from.x), from.y + part * (to.y - from.y),
          WrappedAngle(from.yaw + part * WrappedAngle(to.yaw - from.yaw))};
}

}  // namespace graticule
