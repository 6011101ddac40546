#include "graticule/problems/calibration/camera.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kStep = 0.005;  // rad, of the walk outward

Eigen::Vector3d RayAt(double angle, const Eigen::Vector2d& direction) {
  const double s = std::sin(angle);
  return {s * direction.x(), s * direction.y(), std::cos(angle)};
}

// The angle at which the image of rays in this direction stops moving outward.
double LastAngle(const CameraModel& model, const std::vector<double>& parameters,
                 const Eigen::Vector2d& direction) {
  const double end = model.sees_behind ? M_PI - kStep : M_PI / 2 - kStep;
  const Eigen::Vector2d outward(direction.x() * parameters[0], direction.y() * parameters[1]);
  const auto moves_outward = [&](double angle) {
    double by_point[6];
    double pixel[2];
    const Eigen::Vector3d ray = RayAt(angle, direction);
    if (!model.project(parameters.data(), ray.data(), pixel, by_point, nullptr)) return false;
    const Eigen::Vector3d sideways(std::cos(angle) * direction.x(), std::cos(angle) * direction.y(),
                                   -std::sin(angle));
    const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> j(by_point);
    return (j * sideways).dot(outward) > 0;
  };
  // Long steps first, then short ones from the last that was good.
  constexpr int kLong = 8;
  const int last = static_cast<int>(end / kStep);
  int at = 0;
  while (at + kLong <= last && moves_outward((at + kLong) * kStep)) at += kLong;
  while (at + 1 <= last && moves_outward((at + 1) * kStep)) ++at;
  return at * kStep;
}

}  // namespace

Camera::Camera(CameraIntrinsics intrinsics)
    : intrinsics_(std::move(intrinsics)), model_(&CameraModelOf(intrinsics_.model)) {
  const std::vector<double>& p = intrinsics_.parameters;
  const auto refuse = [&](const std::string& why) {
    throw Error("camera " + intrinsics_.name + ": " + why, ErrorKind::kUsage);
  };
  if (p.size() != static_cast<std::size_t>(model_->parameters))
    refuse("expected " + std::to_string(model_->parameters) + " parameters (" + model_->fields +
           "), found " + std::to_string(p.size()));
  for (const double value : p)
    if (!std::isfinite(value)) refuse("a parameter is not finite");
  if (!(p[0] > 0 && p[1] > 0)) refuse("expected focal lengths above zero");
  if (Width() <= 0 || Height() <= 0) refuse("expected the size of its images");
  max_angle_ = M_PI;
  for (int i = 0; i < 8; ++i) {
    const double turn = M_PI / 4 * i;
    max_angle_ = std::min(max_angle_, LastAngle(*model_, p, {std::cos(turn), std::sin(turn)}));
  }
}

std::optional<Eigen::Vector2d> Camera::Project(const Eigen::Vector3d& in_camera) const {
  return Project(in_camera, nullptr, nullptr);
}

std::optional<Eigen::Vector2d> Camera::Project(const Eigen::Vector3d& in_camera, double* by_point,
                                               double* by_parameters) const {
  const double across = std::hypot(in_camera.x(), in_camera.y());
  if (!(std::atan2(across, in_camera.z()) <= max_angle_)) return std::nullopt;
  Eigen::Vector2d pixel;
  if (!model_->project(intrinsics_.parameters.data(), in_camera.data(), pixel.data(), by_point,
                       by_parameters))
    return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector3d> Camera::Unproject(const Eigen::Vector2d& pixel) const {
  const std::vector<double>& p = intrinsics_.parameters;
  const Eigen::Vector2d plane((pixel.x() - p[2]) / p[0], (pixel.y() - p[3]) / p[1]);
  const double radius = plane.norm();
  if (radius < 1e-14) return Eigen::Vector3d(0, 0, 1);
  const Eigen::Vector2d direction = plane / radius;

  // Along the direction of the pixel the radius grows with the angle: bisection, then Newton's
  // method in both directions, for lenses whose image is not quite radial.
  const auto radius_at = [&](double angle) {
    const Eigen::Vector3d ray = RayAt(angle, direction);
    double at[2];
    if (!model_->project(p.data(), ray.data(), at, nullptr, nullptr)) return HUGE_VAL;
    return std::hypot((at[0] - p[2]) / p[0], (at[1] - p[3]) / p[1]);
  };
  double low = 0, high = max_angle_;
  if (radius_at(high) < radius * (1 - 1e-3)) return std::nullopt;
  for (int i = 0; i < 12; ++i) {
    const double middle = (low + high) / 2;
    (radius_at(middle) < radius ? low : high) = middle;
  }
  Eigen::Vector3d ray = RayAt((low + high) / 2, direction);
  for (int i = 0; i < 20; ++i) {
    Eigen::Vector3d axis_a = Eigen::Vector3d::UnitY().cross(ray);
    if (axis_a.squaredNorm() < 0.1) axis_a = Eigen::Vector3d::UnitX().cross(ray);
    axis_a.normalize();
    Eigen::Matrix<double, 3, 2> tangent;
    tangent << axis_a, ray.cross(axis_a);
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> j;
    Eigen::Vector2d at;
    if (!model_->project(p.data(), ray.data(), at.data(), j.data(), nullptr)) return std::nullopt;
    const Eigen::Matrix2d slope = j * tangent;
    const Eigen::Vector2d step = slope.inverse() * (pixel - at);
    if (!step.allFinite()) return std::nullopt;
    const double length = step.norm();
    ray = (ray + tangent * (length > 0.2 ? Eigen::Vector2d(step * (0.2 / length)) : step))
              .normalized();
    if (length < 1e-11) break;
    if (i == 19 && length > 1e-9) return std::nullopt;
  }
  const double angle = std::atan2(std::hypot(ray.x(), ray.y()), ray.z());
  if (angle > max_angle_) return std::nullopt;
  return ray;
}

}  // namespace graticule
