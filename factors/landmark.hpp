#pragma once

#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

/// A point of the world in the frame of a planar pose, and what that turns on.
struct PointInSe2 {
  double c, s, x_m, y_m;

  PointInSe2(const double* pose, const double* point) : c(std::cos(pose[2])), s(std::sin(pose[2])) {
    const double dx = point[0] - pose[0], dy = point[1] - pose[1];
    x_m = c * dx + s * dy;
    y_m = c * dy - s * dx;
  }

  /// One row of both Jacobians, for a residual that changes by gx, gy with the point in the body.
  void FillRow(int row, double gx, double gy, double** jacobians) const {
    if (double* pose = jacobians[0]) {
      pose[3 * row] = -gx;
      pose[3 * row + 1] = -gy;
      pose[3 * row + 2] = gx * y_m - gy * x_m;
    }
    if (double* point = jacobians[1]) {
      point[2 * row] = gx * c - gy * s;
      point[2 * row + 1] = gx * s + gy * c;
    }
  }
};

/// A landmark lies where the body measured it.
/// Residual [m, m] in the frame of the body: R^T (l - t) - measured; zero when they agree.
/// As the tool g2o: EdgeSE2PointXY.
struct LandmarkSe2 {
  static constexpr const char* kName = "landmark_se2/1";
  static constexpr const char* kSchema = "pose:se2/1 landmark:point2/1 | x:m y:m";
  static constexpr const char* kSummary = "landmark's position seen from a pose, in the plane";
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  double x_m, y_m;

  explicit LandmarkSe2(Measurement m) : x_m(m[0]), y_m(m[1]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const PointInSe2 seen(blocks[0], blocks[1]);
    residual[0] = seen.x_m - x_m;
    residual[1] = seen.y_m - y_m;
    if (!jacobians) return true;
    seen.FillRow(0, 1, 0, jacobians);
    seen.FillRow(1, 0, 1, jacobians);
    return true;
  }
};

/// Direction of a landmark.  False where the landmark is exactly at the pose: it has none.
inline bool BearingOf(const PointInSe2& seen, double measured_rad, double* residual, int row,
                      double** jacobians) {
  const double squared = seen.x_m * seen.x_m + seen.y_m * seen.y_m;
  if (!(squared > 0)) return false;
  *residual = WrapAngle(std::atan2(seen.y_m, seen.x_m) - measured_rad);
  if (jacobians) seen.FillRow(row, -seen.y_m / squared, seen.x_m / squared, jacobians);
  return true;
}

/// Distance of a landmark.  At the pose itself the derivative is that along the body's x axis: one
/// of many, so that a solver can leave the spot.
inline void RangeOf(const PointInSe2& seen, double measured_m, double* residual, int row,
                    double** jacobians) {
  const double range = std::hypot(seen.x_m, seen.y_m);
  *residual = range - measured_m;
  if (!jacobians) return;
  const bool there = range > 0;
  seen.FillRow(row, there ? seen.x_m / range : 1, there ? seen.y_m / range : 0, jacobians);
}

/// The measured distance; throws std::invalid_argument where it is below zero.
inline double CheckedRange(double range_m) {
  if (!(range_m >= 0))
    throw std::invalid_argument("range: expected a distance of 0 m or more, found " +
                                std::to_string(range_m));
  return range_m;
}

/// A landmark lies in the direction measured by the body.
/// Residual [rad], counter-clockwise from the body's x axis, in (-pi, pi]; zero when they agree.
/// As the tool g2o: EdgeSE2PointXYBearing.
struct BearingSe2 {
  static constexpr const char* kName = "bearing_se2/1";
  static constexpr const char* kSchema = "pose:se2/1 landmark:point2/1 | bearing:rad";
  static constexpr const char* kSummary = "landmark's direction seen from a pose, in the plane";
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  double bearing_rad;

  explicit BearingSe2(Measurement m) : bearing_rad(m[0]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    return BearingOf(PointInSe2(blocks[0], blocks[1]), bearing_rad, residual, 0, jacobians);
  }
};

/// A landmark lies as far from the body as measured.
/// Residual [m]; zero when they agree.
struct RangeSe2 {
  static constexpr const char* kName = "range_se2/1";
  static constexpr const char* kSchema = "pose:se2/1 landmark:point2/1 | range:m";
  static constexpr const char* kSummary = "landmark's distance from a pose, in the plane";
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  double range_m;

  explicit RangeSe2(Measurement m) : range_m(CheckedRange(m[0])) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    RangeOf(PointInSe2(blocks[0], blocks[1]), range_m, residual, 0, jacobians);
    return true;
  }
};

/// Both of the above: residual [rad, m].
struct BearingRangeSe2 {
  static constexpr const char* kName = "bearing_range_se2/1";
  static constexpr const char* kSchema = "pose:se2/1 landmark:point2/1 | bearing:rad range:m";
  static constexpr const char* kSummary = "landmark's direction and distance from a planar pose";
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  double bearing_rad, range_m;

  explicit BearingRangeSe2(Measurement m) : bearing_rad(m[0]), range_m(CheckedRange(m[1])) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const PointInSe2 seen(blocks[0], blocks[1]);
    if (!BearingOf(seen, bearing_rad, residual, 0, jacobians)) return false;
    RangeOf(seen, range_m, residual + 1, 1, jacobians);
    return true;
  }
};

/// A landmark lies where the body measured it.
/// Residual [m, m, m] in the frame of the body: R^T (l - t) - measured; zero when they agree.
struct LandmarkSe3 {
  static constexpr const char* kName = "landmark_se3/1";
  static constexpr const char* kSchema = "pose:se3/1 landmark:point3/1 | x:m y:m z:m";
  static constexpr const char* kSummary = "landmark's position seen from a pose";
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  Eigen::Vector3d landmark_in_body;

  explicit LandmarkSe3(Measurement m) : landmark_in_body(m.values) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    RowMajor<3, 3> r;
    QuaternionToMatrix(blocks[0] + 3, r.data());
    const Eigen::Vector3d seen =
        r.transpose() * (Eigen::Vector3d(blocks[1]) - Eigen::Vector3d(blocks[0]));
    Eigen::Map<Eigen::Vector3d>(residual, 3) = seen - landmark_in_body;
    if (jacobians && jacobians[0]) {
      JacobianMap<3, 6> j(jacobians[0]);
      j.leftCols<3>() = -RowMajor<3, 3>::Identity();
      j.rightCols<3>() = Skew(seen);
    }
    if (jacobians && jacobians[1]) JacobianMap<3, 3>{jacobians[1]} = r.transpose();
    return true;
  }
};

/// A landmark lies where a sensor, mounted on the body at body_from_sensor, measured it.
/// Residual [m, m, m] in the frame of the sensor; zero when they agree.
/// As the tool g2o: EdgeSE3PointXYZ with its offset parameter.
struct LandmarkOffsetSe3 {
  static constexpr const char* kName = "landmark_offset_se3/1";
  static constexpr const char* kSchema =
      "pose:se3/1 landmark:point3/1 | x:m y:m z:m sx:m sy:m sz:m sqx sqy sqz sqw | x:m y:m z:m";
  static constexpr const char* kSummary = "landmark's position seen from a sensor on a body";
  static constexpr bool kRelative = true;
  static constexpr bool kTangentJacobians = true;

  Eigen::Vector3d landmark_in_sensor;
  MeasuredPose body_from_sensor;

  explicit LandmarkOffsetSe3(Measurement m)
      : landmark_in_sensor(m.values), body_from_sensor(m.values + 3, "body_from_sensor") {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    RowMajor<3, 3> r;
    QuaternionToMatrix(blocks[0] + 3, r.data());
    const Eigen::Vector3d in_body =
        r.transpose() * (Eigen::Vector3d(blocks[1]) - Eigen::Vector3d(blocks[0]));
    const RowMajor<3, 3> sensor_from_body = body_from_sensor.rotation.transpose();
    Eigen::Map<Eigen::Vector3d>(residual, 3) =
        sensor_from_body * (in_body - body_from_sensor.translation) - landmark_in_sensor;
    if (jacobians && jacobians[0]) {
      JacobianMap<3, 6> j(jacobians[0]);
      j.leftCols<3>() = -sensor_from_body;
      j.rightCols<3>().noalias() = sensor_from_body * Skew(in_body);
    }
    if (jacobians && jacobians[1])
      JacobianMap<3, 3>(jacobians[1]).noalias() = sensor_from_body * r.transpose();
    return true;
  }
};

}  // namespace graticule
