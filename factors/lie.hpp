#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "graticule/solver/rotation.hpp"

namespace graticule {

/// Small pieces of algebra that the pose factors share.  Nothing here allocates.
///
/// Tangents are body-side, as solver/variable.hpp says: t + R d, R Exp(w).

/// Row-major, as Jacobians are handed over.
template <int kRows, int kColumns>
using RowMajor = Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor>;

/// A Jacobian that the host wants filled.
template <int kRows, int kColumns>
using JacobianMap = Eigen::Map<RowMajor<kRows, kColumns>>;

/// Skew(v) u = v x u.
inline RowMajor<3, 3> Skew(const Eigen::Vector3d& v) {
  RowMajor<3, 3> matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// d Log(R Exp(w)) / dw at w = 0, with r = Log(R) [rad].  Up to and including an angle of pi.
inline RowMajor<3, 3> InverseRightJacobian(const Eigen::Vector3d& r) {
  const double squared = r.squaredNorm();
  const RowMajor<3, 3> skew = Skew(r);
  // (1 - (angle/2) cot(angle/2)) / angle^2; below 0.03 rad by its series, whose next term is
  // angle^4/30240.
  double factor = 1.0 / 12 + squared / 720;
  if (squared > 1e-3) {
    const double half = std::sqrt(squared) / 2;
    factor = (1 - half * std::cos(half) / std::sin(half)) / squared;
  }
  return RowMajor<3, 3>::Identity() + 0.5 * skew + factor * (skew * skew);
}

/// A measured pose in space: x y z qx qy qz qw, as its matrix and its quaternion.
/// Throws std::invalid_argument where the quaternion is not one (see NormaliseQuaternion).
struct MeasuredPose {
  RowMajor<3, 3> rotation;
  Eigen::Vector3d translation;
  double quaternion[4];  // x y z w

  MeasuredPose(const double* values, const char* what) : translation(values) {
    std::copy(values + 3, values + 7, quaternion);
    if (!NormaliseQuaternion(quaternion))
      throw std::invalid_argument(
          std::string(what) + ": expected a unit quaternion qx qy qz qw, found one of norm " +
          std::to_string(Eigen::Map<const Eigen::Vector4d>(quaternion).norm()));
    QuaternionToMatrix(quaternion, rotation.data());
  }
};

/// How far a rotation is from none: the vector part of its quaternion with w >= 0, no unit.  Half
/// the angle for small angles, at most 1.  As in the tool g2o (EdgeSE3, toVectorMQT).
struct VectorPart {
  /// Also d/dw of the residual of q Exp(w), unless null.
  static void Evaluate(const double* q, double* residual, RowMajor<3, 3>* jacobian) {
    const double sign = q[3] < 0 ? -1 : 1;
    for (int i = 0; i < 3; ++i) residual[i] = sign * q[i];
    if (!jacobian) return;
    const double x = sign * q[0] / 2, y = sign * q[1] / 2, z = sign * q[2] / 2;
    const double w = sign * q[3] / 2;
    *jacobian << w, -z, y, z, w, -x, -y, x, w;
  }
};

/// How far a rotation is from none: its rotation vector [rad], of length at most pi.
struct RotationVector {
  static void Evaluate(const double* q, double* residual, RowMajor<3, 3>* jacobian) {
    QuaternionLog(q, residual);
    if (jacobian) *jacobian = InverseRightJacobian(Eigen::Vector3d(residual));
  }
};

}  // namespace graticule
