#include "graticule/problems/calibration/view_information.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace graticule {

ViewInformation::ViewInformation(const CameraModel& model, Columns columns)
    : model_(&model),
      columns_(columns),
      size_(model.parameters + 6 + (columns.extrinsics ? 6 : 0) + (columns.warp ? 3 : 0)),
      rows_(2 * size_),
      by_parameters_(2 * model.parameters),
      sums_(size_ * size_) {}

void ViewInformation::Start(const double* parameters, const Eigen::Isometry3d& camera_from_rig,
                            const Eigen::Isometry3d& rig_from_target) {
  parameters_ = parameters;
  camera_from_rig_ = camera_from_rig;
  rig_from_target_ = rig_from_target;
  std::fill(sums_.begin(), sums_.end(), 0);
}

bool ViewInformation::Add(const Eigen::Vector3d& in_target) {
  const Eigen::Vector3d turned = rig_from_target_.linear() * in_target;
  const Eigen::Vector3d in_rig = turned + rig_from_target_.translation();
  const Eigen::Vector3d in_camera = camera_from_rig_ * in_rig;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_camera;
  double pixel[2];
  if (!model_->project(parameters_, in_camera.data(), pixel, by_camera.data(),
                       by_parameters_.data()))
    return false;
  by_rig_.noalias() = by_camera * camera_from_rig_.linear();
  const int n = model_->parameters;
  for (int k = 0; k < 2; ++k) {
    double* row = &rows_[k * size_];
    std::copy_n(&by_parameters_[k * n], n, row);
    row += n;
    const Eigen::Vector3d along = by_rig_.row(k);
    const auto put = [&row](const Eigen::Vector3d& v) {
      for (int i = 0; i < 3; ++i) *row++ = v[i];
    };
    put(along);
    put(turned.cross(along));
    if (columns_.extrinsics) {
      put(along);
      put(in_rig.cross(along));
    }
    if (columns_.warp) {
      const double by_height = along.dot(rig_from_target_.linear().col(2));
      const double x = in_target.x(), y = in_target.y();
      put(by_height * Eigen::Vector3d(x * x, y * y, x * y));
    }
  }
  const double *u = rows_.data(), *v = u + size_;
  for (int i = 0; i < size_; ++i) {
    double* out = &sums_[i * size_];
    for (int j = 0; j <= i; ++j) out[j] += u[i] * u[j] + v[i] * v[j];
  }
  return true;
}

Eigen::MatrixXd ViewInformation::Sums() const {
  Eigen::MatrixXd sums(size_, size_);
  for (int i = 0; i < size_; ++i)
    for (int j = 0; j <= i; ++j) sums(i, j) = sums(j, i) = sums_[i * size_ + j];
  return sums;
}

Eigen::MatrixXd ViewInformation::OfParameters() const {
  const Eigen::MatrixXd sums = Sums();
  const int n = model_->parameters;
  return sums.topLeftCorner(n, n) - PoseShare(sums.block<6, 6>(n, n), sums.block(n, 0, 6, n));
}

Eigen::MatrixXd PoseShare(const Eigen::Matrix<double, 6, 6>& pose,
                          const Eigen::MatrixXd& by_others) {
  if (by_others.cols() == 0) return Eigen::MatrixXd(0, 0);
  // Rows of metres and radians: scaled to a unit diagonal before ranks are judged.
  Eigen::Matrix<double, 6, 1> scale;
  for (int i = 0; i < 6; ++i) scale[i] = pose(i, i) > 0 ? 1 / std::sqrt(pose(i, i)) : 0;
  const Eigen::Matrix<double, 6, 6> scaled = scale.asDiagonal() * pose * scale.asDiagonal();
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(scaled);
  constexpr double kRank = 1e-12;  // a unit diagonal's rounding, with room
  if (factor.info() == Eigen::Success && factor.matrixLLT().diagonal().minCoeff() > 1e-5) {
    const Eigen::MatrixXd half = factor.matrixL().solve(scale.asDiagonal() * by_others);
    return half.transpose() * half;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(scaled);
  Eigen::MatrixXd half = eigen.eigenvectors().transpose() * (scale.asDiagonal() * by_others);
  for (int i = 0; i < 6; ++i)
    half.row(i) *= eigen.eigenvalues()[i] > kRank ? 1 / std::sqrt(eigen.eigenvalues()[i]) : 0;
  return half.transpose() * half;
}

}  // namespace graticule
