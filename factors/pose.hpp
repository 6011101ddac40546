#pragma once

#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

/// Pose b, seen from pose a, is where the measurement a_from_b says.
/// Residual [m, m, rad], in the frame of the measured b; zero when they agree; yaw in (-pi, pi].
/// As the tool g2o: EdgeSE2, error = measurement^-1 * (a^-1 * b).
struct BetweenSe2 {
  static constexpr const char* kName = "between_se2/1";
  static constexpr const char* kSchema = "a:se2/1 b:se2/1 | x:m y:m yaw:rad";
  static constexpr const char* kSummary = "pose b seen from pose a, in the plane";
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  double x_m, y_m, yaw_rad, c_measured, s_measured;

  explicit BetweenSe2(Measurement m)
      : x_m(m[0]),
        y_m(m[1]),
        yaw_rad(m[2]),
        c_measured(std::cos(m[2])),
        s_measured(std::sin(m[2])) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double* a = blocks[0];
    const double* b = blocks[1];
    const double c_a = std::cos(a[2]), s_a = std::sin(a[2]);
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const double x = c_a * dx + s_a * dy, y = c_a * dy - s_a * dx;  // b in a
    const double ex = x - x_m, ey = y - y_m;
    residual[0] = c_measured * ex + s_measured * ey;
    residual[1] = c_measured * ey - s_measured * ex;
    const double turn = b[2] - a[2] - yaw_rad;
    residual[2] = WrapAngle(turn);
    if (!jacobians) return true;
    if (double* j = jacobians[0]) {  // -R_m^T, and R_m^T times (y, -x)
      j[0] = -c_measured, j[1] = -s_measured, j[2] = c_measured * y - s_measured * x;
      j[3] = s_measured, j[4] = -c_measured, j[5] = -s_measured * y - c_measured * x;
      j[6] = 0, j[7] = 0, j[8] = -1;
    }
    if (double* j = jacobians[1]) {  // R_m^T R_a^T R_b
      const double c = std::cos(turn), s = std::sin(turn);
      j[0] = c, j[1] = -s, j[2] = 0;
      j[3] = s, j[4] = c, j[5] = 0;
      j[6] = 0, j[7] = 0, j[8] = 1;
    }
    return true;
  }
};

/// What between_se3_quaternion/1 and between_se3/1 share: E = Z^-1 * (A^-1 * B), as translation
/// and `Rotation` of E.
template <class Rotation>
struct BetweenSe3Base {
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  MeasuredPose a_from_b;

  explicit BetweenSe3Base(Measurement m) : a_from_b(m.values, "measurement") {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double* a = blocks[0];
    const double* b = blocks[1];
    const double a_inverse[4] = {-a[3], -a[4], -a[5], a[6]};
    const double apart[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    Eigen::Vector3d b_in_a;
    QuaternionRotate(a_inverse, apart, b_in_a.data());
    double turned[4], error[4];
    QuaternionProduct(a_inverse, b + 3, turned);
    QuaternionInverseProduct(a_from_b.quaternion, turned, error);

    const RowMajor<3, 3> inverse = a_from_b.rotation.transpose();
    Eigen::Map<Eigen::Vector3d> translation(residual);
    translation.noalias() = inverse * (b_in_a - a_from_b.translation);
    const bool wants = jacobians && (jacobians[0] || jacobians[1]);
    RowMajor<3, 3> rotation_by_b;
    Rotation::Evaluate(error, residual + 3, wants ? &rotation_by_b : nullptr);
    if (!wants) return true;

    RowMajor<3, 3> r;
    QuaternionToMatrix(turned, r.data());  // R_a^T R_b
    if (jacobians[0]) {
      JacobianMap<6, 6> j(jacobians[0]);
      j.topLeftCorner<3, 3>() = -inverse;
      j.topRightCorner<3, 3>().noalias() = inverse * Skew(b_in_a);
      j.bottomLeftCorner<3, 3>().setZero();
      // Exp(-w) turned = turned Exp(-r^T w)
      j.bottomRightCorner<3, 3>().noalias() = -rotation_by_b * r.transpose();
    }
    if (jacobians[1]) {
      JacobianMap<6, 6> j(jacobians[1]);
      j.topLeftCorner<3, 3>().noalias() = inverse * r;
      j.topRightCorner<3, 3>().setZero();
      j.bottomLeftCorner<3, 3>().setZero();
      j.bottomRightCorner<3, 3>() = rotation_by_b;
    }
    return true;
  }
};

/// Pose b, seen from pose a, is where the measurement a_from_b says.
/// Residual [m, m, m] and the vector part of the error's quaternion, w >= 0 [half the angle where
/// it is small], in the frame of the measured b; zero when they agree.  As the tool g2o: EdgeSE3.
struct BetweenSe3Quaternion : BetweenSe3Base<VectorPart> {
  static constexpr const char* kName = "between_se3_quaternion/1";
  static constexpr const char* kSchema =
      "a:se3/1 b:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m qx qy qz";
  static constexpr const char* kSummary =
      "pose b seen from pose a; rotation error as g2o weighs it";
  using BetweenSe3Base::BetweenSe3Base;
};

/// The same with the error's rotation vector [m, m, m, rad, rad, rad]: the full angle, at most pi.
struct BetweenSe3 : BetweenSe3Base<RotationVector> {
  static constexpr const char* kName = "between_se3/1";
  static constexpr const char* kSchema =
      "a:se3/1 b:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m rx:rad ry:rad rz:rad";
  static constexpr const char* kSummary = "pose b seen from pose a; rotation error in radians";
  using BetweenSe3Base::BetweenSe3Base;
};

}  // namespace graticule
