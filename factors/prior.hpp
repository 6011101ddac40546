#pragma once

#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

/// A pose is where the measurement says, in world.
/// Residual [m, m, rad] in the measured frame; zero when they agree; yaw in (-pi, pi].
/// As the tool g2o: EdgeSE2Prior, error = measurement^-1 * pose.
struct PriorSe2 {
  static constexpr const char* kName = "prior_se2/1";
  static constexpr const char* kSchema = "pose:se2/1 | x:m y:m yaw:rad";
  static constexpr const char* kSummary = "pose in the plane is known";
  static constexpr bool kTangentJacobians = true;

  double x_m, y_m, yaw_rad, c_measured, s_measured;

  explicit PriorSe2(Measurement m)
      : x_m(m[0]),
        y_m(m[1]),
        yaw_rad(m[2]),
        c_measured(std::cos(m[2])),
        s_measured(std::sin(m[2])) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double* pose = blocks[0];
    const double dx = pose[0] - x_m, dy = pose[1] - y_m, turn = pose[2] - yaw_rad;
    residual[0] = c_measured * dx + s_measured * dy;
    residual[1] = c_measured * dy - s_measured * dx;
    residual[2] = WrapAngle(turn);
    if (jacobians && jacobians[0]) {
      const double c = std::cos(turn), s = std::sin(turn);
      JacobianMap<3, 3>(jacobians[0]) << c, -s, 0, s, c, 0, 0, 0, 1;
    }
    return true;
  }
};

/// What the priors on poses in space share: E = M^-1 * X * O as translation and `Rotation` of E,
/// with M the measured world_from_sensor and O = body_from_sensor (none: the body itself).
template <class Rotation, bool kHasOffset>
struct PriorSe3Base {
  static constexpr bool kTangentJacobians = true;

  MeasuredPose world_from_sensor;
  MeasuredPose body_from_sensor;

  explicit PriorSe3Base(Measurement m)
      : world_from_sensor(m.values, "measurement"),
        body_from_sensor(kHasOffset ? m.values + 7 : kNone, "body_from_sensor") {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double* pose = blocks[0];
    double in_measured[4], error[4];
    QuaternionInverseProduct(world_from_sensor.quaternion, pose + 3, in_measured);
    QuaternionProduct(in_measured, body_from_sensor.quaternion, error);
    RowMajor<3, 3> r;
    QuaternionToMatrix(in_measured, r.data());  // R_m^T R_x
    const Eigen::Vector3d apart = Eigen::Vector3d(pose) - world_from_sensor.translation;
    Eigen::Map<Eigen::Vector3d>(residual, 3) =
        world_from_sensor.rotation.transpose() * apart + r * body_from_sensor.translation;
    RowMajor<3, 3> rotation_by_sensor;
    const bool wants = jacobians && jacobians[0];
    Rotation::Evaluate(error, residual + 3, wants ? &rotation_by_sensor : nullptr);
    if (!wants) return true;
    JacobianMap<6, 6> j(jacobians[0]);
    j.topLeftCorner<3, 3>() = r;
    j.topRightCorner<3, 3>().noalias() = -r * Skew(body_from_sensor.translation);
    j.bottomLeftCorner<3, 3>().setZero();
    j.bottomRightCorner<3, 3>().noalias() =
        rotation_by_sensor * body_from_sensor.rotation.transpose();
    return true;
  }

 private:
  static constexpr double kNone[7] = {0, 0, 0, 0, 0, 0, 1};
};

/// A pose is where the measurement says, in world.
/// Residual [m, m, m] and the vector part of the error's quaternion, w >= 0, in the measured frame;
/// zero when they agree.  As the tool g2o: EdgeSE3Prior without an offset.
struct PriorSe3Quaternion : PriorSe3Base<VectorPart, false> {
  static constexpr const char* kName = "prior_se3_quaternion/1";
  static constexpr const char* kSchema =
      "pose:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m qx qy qz";
  static constexpr const char* kSummary = "pose is known; rotation error as g2o weighs it";
  using PriorSe3Base::PriorSe3Base;
};

/// The same with the error's rotation vector [m, m, m, rad, rad, rad].
struct PriorSe3 : PriorSe3Base<RotationVector, false> {
  static constexpr const char* kName = "prior_se3/1";
  static constexpr const char* kSchema =
      "pose:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m rx:rad ry:rad rz:rad";
  static constexpr const char* kSummary = "pose is known; rotation error in radians";
  using PriorSe3Base::PriorSe3Base;
};

/// A sensor, mounted on the body at body_from_sensor, is where the measurement world_from_sensor
/// says.  Residual as prior_se3_quaternion/1, in the measured frame of the sensor.
/// As the tool g2o: EdgeSE3Prior with its offset parameter.
struct PriorOffsetSe3Quaternion : PriorSe3Base<VectorPart, true> {
  static constexpr const char* kName = "prior_offset_se3_quaternion/1";
  static constexpr const char* kSchema =
      "pose:se3/1 | x:m y:m z:m qx qy qz qw sx:m sy:m sz:m sqx sqy sqz sqw | "
      "x:m y:m z:m qx qy qz";
  static constexpr const char* kSummary =
      "pose of a sensor on a body is known; rotation error as g2o weighs it";
  using PriorSe3Base::PriorSe3Base;
};

/// The same with the error's rotation vector [m, m, m, rad, rad, rad].
struct PriorOffsetSe3 : PriorSe3Base<RotationVector, true> {
  static constexpr const char* kName = "prior_offset_se3/1";
  static constexpr const char* kSchema =
      "pose:se3/1 | x:m y:m z:m qx qy qz qw sx:m sy:m sz:m sqx sqy sqz sqw | "
      "x:m y:m z:m rx:rad ry:rad rz:rad";
  static constexpr const char* kSummary =
      "pose of a sensor on a body is known; rotation error in radians";
  using PriorSe3Base::PriorSe3Base;
};

/// A point is where the measurement says: residual [m] in world, zero when they agree.
template <int kSize>
struct PriorPointBase {
  std::array<double, kSize> measured_m;

  explicit PriorPointBase(Measurement m) {
    for (int i = 0; i < kSize; ++i) measured_m[static_cast<std::size_t>(i)] = m[i];
  }

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    for (int i = 0; i < kSize; ++i)
      residual[i] = blocks[0][i] - measured_m[static_cast<std::size_t>(i)];
    if (jacobians && jacobians[0]) JacobianMap<kSize, kSize>(jacobians[0]).setIdentity();
    return true;
  }
};

struct PriorPoint2 : PriorPointBase<2> {
  static constexpr const char* kName = "prior_point2/1";
  static constexpr const char* kSchema = "point:point2/1 | x:m y:m";
  static constexpr const char* kSummary = "point in the plane is known";
  using PriorPointBase::PriorPointBase;
};

struct PriorPoint3 : PriorPointBase<3> {
  static constexpr const char* kName = "prior_point3/1";
  static constexpr const char* kSchema = "point:point3/1 | x:m y:m z:m";
  static constexpr const char* kSummary = "point in space is known";
  using PriorPointBase::PriorPointBase;
};

}  // namespace graticule
