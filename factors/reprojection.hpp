#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "graticule/factors/lens.hpp"
#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

namespace reprojection {

template <class Lens>
struct Names {
  static constexpr auto kCamera = TextOf<64>({"camera_", Lens::kName, "/1"});
  static constexpr auto kView = TextOf<64>({"reprojection_", Lens::kName, "/1"});
  static constexpr auto kCorner = TextOf<64>({"corner_reprojection_", Lens::kName, "/1"});
  static constexpr auto kPrior = TextOf<64>({"prior_camera_", Lens::kName, "/1"});
  static constexpr auto kPriorSchema =
      TextOf<192>({"camera:camera_", Lens::kName, "/1 | ", Lens::kFields});
  static constexpr auto kViewSchema =
      TextOf<256>({"camera:camera_", Lens::kName,
                   "/1 camera_from_rig:se3/1 rig_from_target:se3/1 warp:board_warp/1 | "
                   "x:m y:m z:m u:px v:px* | u:px v:px*"});
  static constexpr auto kCornerSchema =
      TextOf<256>({"camera:camera_", Lens::kName,
                   "/1 camera_from_rig:se3/1 rig_from_target:se3/1 corner:point3/1 | u:px v:px"});
};

/// The chain from target to camera, made once a factor's evaluation.
struct Chain {
  RowMajor<3, 3> camera_from_rig, rig_from_target;
  Eigen::Vector3d rig_in_camera, target_in_rig;

  Chain(const double* camera_from_rig_pose, const double* rig_from_target_pose)
      : rig_in_camera(camera_from_rig_pose), target_in_rig(rig_from_target_pose) {
    QuaternionToMatrix(camera_from_rig_pose + 3, camera_from_rig.data());
    QuaternionToMatrix(rig_from_target_pose + 3, rig_from_target.data());
  }

  /// Two rows of the poses' tangent Jacobians, from d(pixel)/d(point in camera) (2 x 3).
  void FillRows(const RowMajor<2, 3>& by_camera, const Eigen::Vector3d& in_rig,
                const Eigen::Vector3d& in_target, double* by_camera_pose,
                double* by_target_pose) const {
    const RowMajor<2, 3> by_rig = by_camera * camera_from_rig;
    if (by_camera_pose) {
      JacobianMap<2, 6> j(by_camera_pose);
      j.leftCols<3>() = by_rig;
      j.rightCols<3>().noalias() = -by_rig * Skew(in_rig);
    }
    if (by_target_pose) {
      const RowMajor<2, 3> by_target = by_rig * rig_from_target;
      JacobianMap<2, 6> j(by_target_pose);
      j.leftCols<3>() = by_target;
      j.rightCols<3>().noalias() = -by_target * Skew(in_target);
    }
  }
};

}  // namespace reprojection

/// A camera's parameters as a variable: fx fy cx cy [px], then the lens' terms.
template <class Lens>
struct CameraVariable {
  static constexpr const char* kName = reprojection::Names<Lens>::kCamera.data();
  static constexpr const char* kFields = Lens::kFields;
  static constexpr const char* kTangent = Lens::kFields;
  static constexpr const char* kSummary = "a camera's intrinsic parameters";
};

/// A camera's parameters are known.  Residual in their units: parameters - measured; zero when they
/// agree.
template <class Lens>
struct PriorCamera {
  static constexpr const char* kName = reprojection::Names<Lens>::kPrior.data();
  static constexpr const char* kSchema = reprojection::Names<Lens>::kPriorSchema.data();
  static constexpr const char* kSummary = "a camera's parameters are known";
  static constexpr int kSize = 4 + Lens::kTerms;

  std::array<double, kSize> measured;

  explicit PriorCamera(Measurement m) { std::copy(m.values, m.values + kSize, measured.begin()); }

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    for (int i = 0; i < kSize; ++i) residual[i] = blocks[0][i] - measured[i];
    if (jacobians && jacobians[0]) JacobianMap<kSize, kSize>(jacobians[0]).setIdentity();
    return true;
  }
};

/// How a board that should be flat is bent: z = xx x^2 + yy y^2 + xy x y, in the target's frame.
/// Constant and linear terms would be a motion of the target.
struct BoardWarp {
  static constexpr const char* kName = "board_warp/1";
  static constexpr const char* kFields = "xx:1/m yy:1/m xy:1/m";
  static constexpr const char* kTangent = kFields;
  static constexpr const char* kSummary = "bend of a board, a quadratic height over it";
};

/// One view of a target: its corners project where the camera saw them.  One factor a view: all of
/// its corners share the chain of frames.
/// Residual [px, px] a corner: projected - measured; zero when they agree.  A corner at (x, y, z)
/// of the target stands at z + xx x^2 + yy y^2 + xy x y.  With one camera, camera_from_rig is the
/// identity, fixed.  Thesis, section 5.1 (the rows of J in equation 5.1).
template <class Lens>
struct Reprojection {
  static constexpr const char* kName = reprojection::Names<Lens>::kView.data();
  static constexpr const char* kSchema = reprojection::Names<Lens>::kViewSchema.data();
  static constexpr const char* kSummary = "corners of a target where a camera saw them";
  static constexpr bool kTangentJacobians = true;
  static constexpr int kCameraSize = 4 + Lens::kTerms;

  std::vector<double> corners;  // x y z u v each

  explicit Reprojection(Measurement m) : corners(m.values, m.values + m.size) {
    if (m.size == 0 || m.size % 5 != 0)
      throw std::invalid_argument("expected five numbers a corner: x y z u v");
  }

  int ResidualSize() const { return static_cast<int>(corners.size() / 5 * 2); }

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const reprojection::Chain chain(blocks[1], blocks[2]);
    const double* warp = blocks[3];
    const std::size_t count = corners.size() / 5;
    for (std::size_t i = 0; i < count; ++i, residual += 2) {
      const double* c = &corners[5 * i];
      const double xx = c[0] * c[0], yy = c[1] * c[1], xy = c[0] * c[1];
      const Eigen::Vector3d in_target(c[0], c[1],
                                      c[2] + warp[0] * xx + warp[1] * yy + warp[2] * xy);
      const Eigen::Vector3d in_rig = chain.rig_from_target * in_target + chain.target_in_rig;
      const Eigen::Vector3d in_camera = chain.camera_from_rig * in_rig + chain.rig_in_camera;
      RowMajor<2, 3> by_camera;
      double* by_parameters =
          jacobians && jacobians[0] ? jacobians[0] + 2 * i * kCameraSize : nullptr;
      if (!ProjectThrough<Lens>(blocks[0], in_camera.data(), residual,
                                jacobians ? by_camera.data() : nullptr, by_parameters))
        return false;
      residual[0] -= c[3];
      residual[1] -= c[4];
      if (!jacobians) continue;
      chain.FillRows(by_camera, in_rig, in_target, jacobians[1] ? jacobians[1] + 12 * i : nullptr,
                     jacobians[2] ? jacobians[2] + 12 * i : nullptr);
      if (jacobians[3]) {
        const Eigen::Vector3d up =
            chain.camera_from_rig * chain.rig_from_target.col(2);  // the board's z in the camera
        const Eigen::Vector2d by_height = by_camera * up;
        JacobianMap<2, 3>(jacobians[3] + 6 * i).noalias() =
            by_height * Eigen::RowVector3d(xx, yy, xy);
      }
    }
    return true;
  }
};

/// One corner of a target whose shape is estimated too.
/// Residual [px, px]: projected - measured; zero when they agree.  Frames as above.
template <class Lens>
struct CornerReprojection {
  static constexpr const char* kName = reprojection::Names<Lens>::kCorner.data();
  static constexpr const char* kSchema = reprojection::Names<Lens>::kCornerSchema.data();
  static constexpr const char* kSummary = "a corner, its place free, where a camera saw it";
  static constexpr bool kTangentJacobians = true;

  double u_px, v_px;

  explicit CornerReprojection(Measurement m) : u_px(m[0]), v_px(m[1]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const reprojection::Chain chain(blocks[1], blocks[2]);
    const Eigen::Vector3d in_target(blocks[3]);
    const Eigen::Vector3d in_rig = chain.rig_from_target * in_target + chain.target_in_rig;
    const Eigen::Vector3d in_camera = chain.camera_from_rig * in_rig + chain.rig_in_camera;
    RowMajor<2, 3> by_camera;
    if (!ProjectThrough<Lens>(blocks[0], in_camera.data(), residual,
                              jacobians ? by_camera.data() : nullptr,
                              jacobians ? jacobians[0] : nullptr))
      return false;
    residual[0] -= u_px;
    residual[1] -= v_px;
    if (!jacobians) return true;
    chain.FillRows(by_camera, in_rig, in_target, jacobians[1], jacobians[2]);
    if (jacobians[3])
      JacobianMap<2, 3>(jacobians[3]).noalias() =
          by_camera * (chain.camera_from_rig * chain.rig_from_target);
    return true;
  }
};

}  // namespace graticule
