#pragma once

#include "graticule/factors/lens.hpp"
#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

namespace registration {

template <class Lens>
struct Names {
  static constexpr auto kPoint = TextOf<64>({"point_reprojection_", Lens::kName, "/1"});
  static constexpr auto kPointSchema =
      TextOf<192>({"camera:camera_", Lens::kName,
                   "/1 camera_from_lidar:se3/1 | x:m y:m z:m u:px v:px | u:px v:px"});
};

}  // namespace registration

/// A point that a LIDAR measured at (x, y, z) of its frame is where a camera saw it.
/// Residual [px, px]: projected - seen; zero when they agree.  Thesis, equations 4.1 and 4.2, the
/// servo's T already applied.
template <class Lens>
struct PointReprojection {
  static constexpr const char* kName = registration::Names<Lens>::kPoint.data();
  static constexpr const char* kSchema = registration::Names<Lens>::kPointSchema.data();
  static constexpr const char* kSummary = "a LIDAR's point where a camera saw it";
  static constexpr bool kTangentJacobians = true;

  Eigen::Vector3d in_lidar;
  double u_px, v_px;

  explicit PointReprojection(Measurement m) : in_lidar(m[0], m[1], m[2]), u_px(m[3]), v_px(m[4]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    RowMajor<3, 3> camera_from_lidar;
    QuaternionToMatrix(blocks[1] + 3, camera_from_lidar.data());
    const Eigen::Vector3d in_camera =
        camera_from_lidar * in_lidar + Eigen::Map<const Eigen::Vector3d>(blocks[1]);
    RowMajor<2, 3> by_camera;
    if (!ProjectThrough<Lens>(blocks[0], in_camera.data(), residual,
                              jacobians ? by_camera.data() : nullptr,
                              jacobians ? jacobians[0] : nullptr))
      return false;
    residual[0] -= u_px;
    residual[1] -= v_px;
    if (!jacobians || !jacobians[1]) return true;
    JacobianMap<2, 6> j(jacobians[1]);
    j.leftCols<3>().noalias() = by_camera * camera_from_lidar;
    j.rightCols<3>().noalias() = -j.leftCols<3>() * Skew(in_lidar);
    return true;
  }
};

/// The plane of a board that a LIDAR measured is the one that a camera saw.
/// Residual [1, 1, m]: the LIDAR's normal along the board's x and y (the sines of the tilts
/// between the planes), and how far the board's origin is in front of the LIDAR's plane; zero when
/// they agree.  The plane is normal . p = offset in the LIDAR's frame; the board lies in the plane
/// z = 0 of its own.  After Zhang and Pless, Extrinsic calibration of a camera and laser range
/// finder, IROS 2004.
struct BoardPlane {
  static constexpr const char* kName = "board_plane/1";
  static constexpr const char* kSchema =
      "camera_from_lidar:se3/1 | x:m y:m z:m qx qy qz qw nx ny nz offset:m | tilt_x tilt_y "
      "distance:m";
  static constexpr const char* kSummary = "a board's plane, seen by a LIDAR and by a camera";
  static constexpr bool kTangentJacobians = true;

  Eigen::Vector3d board_in_camera, normal_in_lidar;
  RowMajor<3, 3> camera_from_board;
  double offset_m;

  explicit BoardPlane(Measurement m)
      : board_in_camera(m[0], m[1], m[2]), normal_in_lidar(m[7], m[8], m[9]), offset_m(m[10]) {
    QuaternionToMatrix(m.values + 3, camera_from_board.data());
  }

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    RowMajor<3, 3> camera_from_lidar;
    QuaternionToMatrix(blocks[0] + 3, camera_from_lidar.data());
    const Eigen::Vector3d normal = camera_from_lidar * normal_in_lidar;  // in the camera
    const Eigen::Vector3d off = board_in_camera - Eigen::Map<const Eigen::Vector3d>(blocks[0]);
    residual[0] = camera_from_board.col(0).dot(normal);
    residual[1] = camera_from_board.col(1).dot(normal);
    residual[2] = normal.dot(off) - offset_m;
    if (!jacobians || !jacobians[0]) return true;
    // Turned on the right by w: normal changes by R (w x n) = -R [n] w; moved by R d.
    const RowMajor<3, 3> turned = -camera_from_lidar * Skew(normal_in_lidar);
    JacobianMap<3, 6> j(jacobians[0]);
    j.setZero();
    j.block<1, 3>(0, 3).noalias() = camera_from_board.col(0).transpose() * turned;
    j.block<1, 3>(1, 3).noalias() = camera_from_board.col(1).transpose() * turned;
    j.block<1, 3>(2, 3).noalias() = off.transpose() * turned;
    j.block<1, 3>(2, 0) = -normal_in_lidar.transpose();
    return true;
  }
};

}  // namespace graticule
