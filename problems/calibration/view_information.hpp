#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "graticule/factors/camera_model.hpp"

namespace graticule {

/// Information that the corners of one view carry, for pixel noise of 1: J' J of the camera's
/// parameters, the target's pose, and where they are asked for camera_from_rig and the board's
/// warp, in this order.
///
/// The pose's tangent is [translation, rotation about the target's origin] along the rig's axes:
/// who eliminates a variable may choose its tangent, and this one costs no rotation of a row.  That
/// of camera_from_rig is the graph's, on the rig's side.
class ViewInformation {
 public:
  struct Columns {
    bool extrinsics = false, warp = false;
  };
  ViewInformation(const CameraModel& model, Columns columns);

  int Size() const { return size_; }
  int PoseAt() const { return model_->parameters; }
  int ExtrinsicsAt() const { return model_->parameters + 6; }  ///< if asked for
  int WarpAt() const { return size_ - 3; }                     ///< if asked for

  /// Forgets the corners; others follow, of a target that stands here.
  void Start(const double* parameters, const Eigen::Isometry3d& camera_from_rig,
             const Eigen::Isometry3d& rig_from_target);

  /// Adds a corner, at its place on the target [m].  False, and nothing
  /// added, where the model has no image of it.
  bool Add(const Eigen::Vector3d& in_target);

  /// The rows of J of the last corner, 2 x Size(), and d(pixel)/d(place on the target).
  Eigen::Map<const Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>> Rows() const {
    return {rows_.data(), 2, size_};
  }
  Eigen::Matrix<double, 2, 3> ByTarget() const { return by_rig_ * rig_from_target_.linear(); }

  /// J' J, symmetric.
  Eigen::MatrixXd Sums() const;

  /// Of the parameters alone, the pose eliminated; without extrinsics and warp only.
  Eigen::MatrixXd OfParameters() const;

 private:
  const CameraModel* model_;
  Columns columns_;
  int size_;
  const double* parameters_ = nullptr;
  Eigen::Isometry3d camera_from_rig_, rig_from_target_;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_rig_;
  std::vector<double> rows_, by_parameters_, sums_;
};

/// What the others lose when a pose is eliminated: B' A^-1 B, with the pose's information A and
/// B of pose by others (6 x n).  Directions of the pose that nothing tells anything of lose
/// nothing.
Eigen::MatrixXd PoseShare(const Eigen::Matrix<double, 6, 6>& pose,
                          const Eigen::MatrixXd& by_others);

}  // namespace graticule
