#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "graticule/factors/make.hpp"
#include "graticule/io/camera_file.hpp"
#include "graticule/io/detections.hpp"

namespace graticule {

/// How the target's shape is treated.
enum class BoardShape {
  kFlat,    ///< as its description says
  kWarped,  ///< bent by a quadratic height: the factor's board_warp/1
  kFree,    ///< every corner has a place of its own, with a prior at the description's
};

constexpr Se3Array kIdentityPose = {0, 0, 0, 0, 0, 0, 1};

/// Everything that calibration estimates.
struct CalibrationState {
  std::vector<CameraIntrinsics> cameras;
  std::vector<Se3Array> camera_from_rig;  ///< the first is the identity: the rig's frame
  /// One an exposure; none where its place is not known, or it is left out.
  std::vector<std::optional<Se3Array>> rig_from_target;
  std::array<double, 3> warp = {};               ///< xx yy xy [1/m]
  std::map<int, std::array<double, 3>> corners;  ///< by id, in the target's frame [m]; kFree only
};

/// Where a corner of the target is, in the target's frame [m]: bent, or moved, as the state says.
inline Eigen::Vector3d PlaceOf(const CalibrationState& state, const DetectedCorner& corner) {
  if (const auto moved = state.corners.find(corner.id); moved != state.corners.end())
    return Eigen::Vector3d(moved->second.data());
  const double x = corner.in_target[0], y = corner.in_target[1];
  const std::array<double, 3>& w = state.warp;
  return {x, y, corner.in_target[2] + w[0] * x * x + w[1] * y * y + w[2] * x * y};
}

/// A pose x y z qx qy qz qw as Eigen has it.
inline Eigen::Isometry3d IsometryOf(const Se3Array& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.translation() = Eigen::Vector3d(pose.data());
  isometry.linear() =
      Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]).normalized().toRotationMatrix();
  return isometry;
}

inline Se3Array PoseOf(const Eigen::Isometry3d& isometry) {
  const Eigen::Quaterniond q(isometry.linear());
  const auto& t = isometry.translation();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

}  // namespace graticule
