#include "graticule/problems/calibration/target_pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "graticule/factors/lie.hpp"

namespace graticule {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// The tangent's step, as solver/variable.hpp has it: t + R d, R Exp(w).
Eigen::Isometry3d Plus(const Eigen::Isometry3d& pose, const Vector6& step) {
  Eigen::Isometry3d moved = pose;
  moved.translation() += pose.linear() * step.head<3>();
  const double angle = step.tail<3>().norm();
  if (angle > 0)
    moved.linear() =
        pose.linear() * Eigen::AngleAxisd(angle, step.tail<3>() / angle).toRotationMatrix();
  return moved;
}

struct Cost {
  double robust = 0;   // sum of Huber's loss
  double squares = 0;  // sum of squared distances, each at most kFarOff's
};

// Adds up what one pose costs; with `information`, its normal equations too.
Cost Evaluate(const Camera& camera, const CornerPairs& corners, const Eigen::Isometry3d& pose,
              double huber_px, Matrix6* information, Vector6* gradient) {
  Cost cost;
  if (information) {
    information->setZero();
    gradient->setZero();
  }
  const CameraModel& model = camera.Model();
  const double* parameters = camera.Intrinsics().parameters.data();
  for (std::size_t i = 0; i < corners.pixels.size(); ++i) {
    const Eigen::Vector3d in_camera = pose * corners.in_target[i];
    Eigen::Vector2d pixel;
    RowMajor<2, 3> by_point;
    double squared = TargetPose::kFarOff * TargetPose::kFarOff;
    const bool is_seen = model.project(parameters, in_camera.data(), pixel.data(),
                                       information ? by_point.data() : nullptr, nullptr);
    const Eigen::Vector2d residual = is_seen ? Eigen::Vector2d(pixel - corners.pixels[i])
                                             : Eigen::Vector2d(TargetPose::kFarOff, 0);
    squared = std::min(squared, residual.squaredNorm());
    const double distance = std::sqrt(squared);
    const bool is_far = distance > huber_px;
    cost.squares += squared;
    cost.robust += is_far ? huber_px * (2 * distance - huber_px) : squared;
    if (!information || !is_seen) continue;
    Eigen::Matrix<double, 2, 6> j;
    j.leftCols<3>() = by_point * pose.linear();
    j.rightCols<3>() = -j.leftCols<3>() * Skew(corners.in_target[i]);
    const double weight = is_far ? huber_px / residual.norm() : 1;
    information->noalias() += weight * j.transpose() * j;
    gradient->noalias() += weight * j.transpose() * residual;
  }
  return cost;
}

// The same place, tilted the other way about the line of sight.
Eigen::Isometry3d Mirrored(const Eigen::Isometry3d& pose, const Eigen::Vector3d& centre_in_target) {
  const Eigen::Vector3d centre = pose * centre_in_target, sight = centre.normalized();
  const Eigen::Vector3d normal = pose.linear().col(2);
  const Eigen::Vector3d other = 2 * normal.dot(sight) * sight - normal;
  Eigen::Isometry3d mirrored = pose;
  mirrored.linear() =
      Eigen::Quaterniond::FromTwoVectors(normal, other).toRotationMatrix() * pose.linear();
  mirrored.translation() = centre - mirrored.linear() * centre_in_target;
  return mirrored;
}

}  // namespace

std::optional<Eigen::Isometry3d> PoseFromRays(const std::vector<Eigen::Vector3d>& in_target,
                                              const std::vector<Eigen::Vector3d>& rays) {
  const std::size_t count = in_target.size();
  if (count < 4) return std::nullopt;
  // Coordinates about the middle, of length one.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& place : in_target) middle += place.head<2>();
  middle /= static_cast<double>(count);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3d& place : in_target) {
    const Eigen::Vector2d d = place.head<2>() - middle;
    spread += d * d.transpose();
  }
  const Eigen::Vector2d extents =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues();
  if (!(extents[0] > 1e-6 * extents[1])) return std::nullopt;
  const double scale = std::sqrt(spread.trace() / static_cast<double>(count));

  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d x((in_target[i].x() - middle.x()) / scale,
                            (in_target[i].y() - middle.y()) / scale, 1);
    // ray x (H x) = 0: with P = I - ray ray', the squared sine of the angle between them
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - rays[i] * rays[i].transpose();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) normal.block<3, 3>(3 * a, 3 * b) += x[a] * x[b] * across;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(normal);
  Eigen::Map<const Eigen::Matrix3d> found(eigen.eigenvectors().col(0).data());
  Eigen::Matrix3d h = found;
  double agreement = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d x((in_target[i].x() - middle.x()) / scale,
                            (in_target[i].y() - middle.y()) / scale, 1);
    agreement += rays[i].dot((h * x).normalized());
  }
  if (agreement < 0) h = -h;
  const double size = std::sqrt(h.col(0).norm() * h.col(1).norm());
  if (!(size > 1e-12)) return std::nullopt;
  Eigen::Matrix3d axes;
  axes << h.col(0) / size, h.col(1) / size, (h.col(0) / size).cross(h.col(1) / size);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  if (turn.determinant() < 0)
    turn = svd.matrixU() * Eigen::Vector3d(1, 1, -1).asDiagonal() * svd.matrixV().transpose();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turn;
  pose.translation() =
      h.col(2) * (scale / size) - turn * Eigen::Vector3d(middle.x(), middle.y(), 0);
  if (!pose.matrix().allFinite()) return std::nullopt;
  return pose;
}

TargetPose RefineTargetPose(const Camera& camera, const CornerPairs& corners,
                            const Eigen::Isometry3d& start, double huber_px, int iterations) {
  Eigen::Isometry3d pose = start;
  Matrix6 information;
  Vector6 gradient;
  double damping = 1e-6;
  Cost cost = Evaluate(camera, corners, pose, huber_px, &information, &gradient);
  for (int i = 0; i < iterations; ++i) {
    Matrix6 damped = information;
    damped.diagonal() *= 1 + damping;
    const Vector6 step = damped.ldlt().solve(-gradient);
    if (!step.allFinite()) break;
    const Eigen::Isometry3d moved = Plus(pose, step);
    Matrix6 next_information;
    Vector6 next_gradient;
    const Cost next = Evaluate(camera, corners, moved, huber_px, &next_information, &next_gradient);
    if (next.robust < cost.robust) {
      const bool is_settled = cost.robust - next.robust < 1e-12 * cost.robust;
      pose = moved;
      cost = next;
      information = next_information;
      gradient = next_gradient;
      damping = std::max(damping / 10, 1e-9);
      if (is_settled) break;
    } else {
      damping *= 10;
      if (damping > 1e6) break;
    }
  }
  const auto count = static_cast<double>(std::max<std::size_t>(corners.pixels.size(), 1));
  return {pose, std::sqrt(cost.squares / count)};
}

std::optional<TargetPose> FindTargetPose(const Camera& camera, const CornerPairs& corners,
                                         double huber_px, int iterations) {
  std::vector<Eigen::Vector3d> places, rays;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < corners.pixels.size(); ++i) {
    centre += corners.in_target[i];
    if (const auto ray = camera.Unproject(corners.pixels[i])) {
      places.push_back(corners.in_target[i]);
      rays.push_back(*ray);
    }
  }
  const auto start = PoseFromRays(places, rays);
  if (!start) return std::nullopt;
  centre /= static_cast<double>(corners.pixels.size());
  const TargetPose first = RefineTargetPose(camera, corners, *start, huber_px, iterations);
  const TargetPose second = RefineTargetPose(
      camera, corners, Mirrored(first.camera_from_target, centre), huber_px, iterations);
  return second.rms_px < first.rms_px ? second : first;
}

}  // namespace graticule
