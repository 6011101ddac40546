#pragma once

#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

/// A body is at a measured place; its heading is not measured.
/// Residual [m, m] in world: t - measured; zero when they agree.
struct PositionSe2 {
  static constexpr const char* kName = "position_se2/1";
  static constexpr const char* kSchema = "pose:se2/1 | x:m y:m";
  static constexpr const char* kSummary = "position of a body in the plane is known";
  static constexpr bool kTangentJacobians = true;

  double x_m, y_m;

  explicit PositionSe2(Measurement m) : x_m(m[0]), y_m(m[1]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double* pose = blocks[0];
    residual[0] = pose[0] - x_m;
    residual[1] = pose[1] - y_m;
    if (jacobians && jacobians[0]) {
      const double c = std::cos(pose[2]), s = std::sin(pose[2]);
      JacobianMap<2, 3>(jacobians[0]) << c, -s, 0, s, c, 0;
    }
    return true;
  }
};

/// A GNSS antenna is at a measured place.  The world frame is local east-north-up; the antenna sits
/// on the body at the lever arm, given in the body's frame.
/// Residual [m, m, m] east, north, up: t + R lever - measured; zero when they agree.
struct PositionSe3 {
  static constexpr const char* kName = "position_se3/1";
  static constexpr const char* kSchema =
      "pose:se3/1 | east:m north:m up:m lever_x:m lever_y:m lever_z:m | east:m north:m up:m";
  static constexpr const char* kSummary = "GNSS antenna's position, with its lever arm";
  static constexpr bool kTangentJacobians = true;

  Eigen::Vector3d antenna_in_world, lever_in_body;

  explicit PositionSe3(Measurement m) : antenna_in_world(m.values), lever_in_body(m.values + 3) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    RowMajor<3, 3> r;
    QuaternionToMatrix(blocks[0] + 3, r.data());
    Eigen::Map<Eigen::Vector3d>(residual, 3) =
        Eigen::Vector3d(blocks[0]) + r * lever_in_body - antenna_in_world;
    if (jacobians && jacobians[0]) {
      JacobianMap<3, 6> j(jacobians[0]);
      j.leftCols<3>() = r;
      j.rightCols<3>().noalias() = -r * Skew(lever_in_body);
    }
    return true;
  }
};

}  // namespace graticule
