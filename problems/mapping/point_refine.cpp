#include "graticule/problems/mapping/point_refine.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

constexpr float kNormalsAgree = 0.7f;    // cosine of the angle between them
constexpr double kStop = 1e-5;           // m, rad
constexpr double kLeastReach = 0.08;     // m
constexpr double kLeastDefinite = 1e-9;  // so that a corridor does not divide by zero

}  // namespace

void PointIndex::Build(Span<const SurfacePoint> points) {
  float low_x = HUGE_VALF, low_y = HUGE_VALF, high_x = -HUGE_VALF, high_y = -HUGE_VALF;
  std::size_t count = 0;
  for (const SurfacePoint& p : points) {
    if (p.nx == 0 && p.ny == 0) continue;
    ++count;
    low_x = std::min(low_x, p.x), low_y = std::min(low_y, p.y);
    high_x = std::max(high_x, p.x), high_y = std::max(high_y, p.y);
  }
  const float cell = static_cast<float>(kCell);
  if (count == 0) low_x = low_y = high_x = high_y = 0;
  origin_x_ = low_x - cell, origin_y_ = low_y - cell;
  width_ = static_cast<int>((high_x - origin_x_) / cell) + 2;
  height_ = static_cast<int>((high_y - origin_y_) / cell) + 2;
  first_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
  cell_of_.clear();
  for (const SurfacePoint& p : points) {
    if (p.nx == 0 && p.ny == 0) continue;
    const auto x = static_cast<std::uint32_t>((p.x - origin_x_) / cell);
    const auto y = static_cast<std::uint32_t>((p.y - origin_y_) / cell);
    cell_of_.push_back(y * static_cast<std::uint32_t>(width_) + x);
    ++first_[cell_of_.back() + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sorted_.resize(count);
  std::size_t i = count;
  for (std::size_t k = points.size(); k-- > 0;) {
    if (points[k].nx == 0 && points[k].ny == 0) continue;
    --i;
    sorted_[--first_[cell_of_[i] + 1]] = points[k];
  }
  // first_[c + 1] is now where c begins.
  first_.erase(first_.begin());
  first_.push_back(static_cast<std::uint32_t>(count));
}

const SurfacePoint* PointIndex::Nearest(float x, float y, float nx, float ny, float reach) const {
  const float cell = static_cast<float>(kCell);
  const int cx = static_cast<int>(std::floor((x - origin_x_) / cell));
  const int cy = static_cast<int>(std::floor((y - origin_y_) / cell));
  const int x0 = std::max(cx - 1, 0), x1 = std::min(cx + 1, width_ - 1);
  const SurfacePoint* best = nullptr;
  float least = reach * reach;
  if (x0 > x1) return nullptr;
  for (int row = std::max(cy - 1, 0); row <= std::min(cy + 1, height_ - 1); ++row) {
    const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
    const std::uint32_t from = first_[base + static_cast<std::size_t>(x0)];
    const std::uint32_t to = first_[base + static_cast<std::size_t>(x1) + 1];
    for (std::uint32_t i = from; i < to; ++i) {
      const SurfacePoint& p = sorted_[i];
      const float dx = p.x - x, dy = p.y - y, d = dx * dx + dy * dy;
      if (d >= least || p.nx * nx + p.ny * ny < kNormalsAgree) continue;
      least = d;
      best = &p;
    }
  }
  return best;
}

Refinement RefineOnPoints(const PointIndex& reference, Span<const SurfacePoint> scan,
                          const PlanarPose& start, const PlanarPose& guess,
                          const Eigen::Matrix3d& prior, double residual_sigma,
                          const RefineOptions& options) {
  Refinement result;
  PlanarPose pose = start;
  double reach = options.reach;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    double squares = 0, weights = 0;
    std::size_t usable = 0;
    result.points = 0;
    for (const SurfacePoint& p : scan) {
      if (p.nx == 0 && p.ny == 0) continue;
      ++usable;
      const double px = static_cast<double>(p.x), py = static_cast<double>(p.y);
      const double x = pose.x + c * px - s * py, y = pose.y + s * px + c * py;
      const double mx = static_cast<double>(p.nx), my = static_cast<double>(p.ny);
      const SurfacePoint* q = reference.Nearest(
          static_cast<float>(x), static_cast<float>(y), static_cast<float>(c * mx - s * my),
          static_cast<float>(s * mx + c * my), static_cast<float>(reach));
      if (!q) continue;
      const double nx = static_cast<double>(q->nx), ny = static_cast<double>(q->ny);
      const double r = nx * (x - static_cast<double>(q->x)) + ny * (y - static_cast<double>(q->y));
      const double bx = c * nx + s * ny, by = c * ny - s * nx;  // the normal, in the scan
      const Eigen::Vector3d j(bx, by, by * px - bx * py);
      const double w = 1 / (1 + r * r / (options.scale * options.scale));
      h.noalias() += w * j * j.transpose();
      g += w * r * j;
      squares += w * r * r;
      weights += w;
      ++result.points;
    }
    result.matched = usable ? static_cast<double>(result.points) / static_cast<double>(usable) : 0;
    result.rms = std::sqrt(squares / std::max(weights, 1e-12));
    result.information = h;
    const double variance = residual_sigma * residual_sigma;
    const PlanarPose apart = Inverse(guess) * pose;
    // d of guess^-1 * pose * exp(step), in the frame of the pose.
    const double ca = std::cos(apart.yaw), sa = std::sin(apart.yaw);
    Eigen::Matrix3d turn;
    turn << ca, -sa, 0, sa, ca, 0, 0, 0, 1;
    const Eigen::Vector3d d(apart.x, apart.y, apart.yaw);
    const Eigen::Matrix3d lambda = turn.transpose() * prior * turn;
    const Eigen::Matrix3d a = h + variance * lambda + kLeastDefinite * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d b = g + variance * turn.transpose() * prior * d;
    const Eigen::Vector3d step = -a.ldlt().solve(b);
    if (!step.allFinite()) break;
    pose = pose * PlanarPose{step[0], step[1], step[2]};
    const bool small = step.cwiseAbs().maxCoeff() < kStop;
    if (small && reach <= kLeastReach) break;
    reach = std::max(reach * 0.7, kLeastReach);
  }
  result.reference_from_scan = pose;
  return result;
}

}  // namespace graticule
