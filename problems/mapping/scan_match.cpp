#include "graticule/problems/mapping/scan_match.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

constexpr std::size_t kBatch = 32;
constexpr double kLeastStep = 0.002, kLargestStep = 0.05;  // rad

/// By how much to turn so that a point far out moves by a cell.
double YawStep(Span<const SurfacePoint> points, double cell) {
  double squares = 0;
  for (const SurfacePoint& p : points)
    squares += static_cast<double>(p.x) * static_cast<double>(p.x) +
               static_cast<double>(p.y) * static_cast<double>(p.y);
  const double far =
      1.5 * std::sqrt(squares / static_cast<double>(std::max<std::size_t>(points.size(), 1)));
  return std::min(std::max(cell / std::max(far, cell), kLeastStep), kLargestStep);
}

}  // namespace

bool CorrelativeMatcher::Worse(const Node& a, const Node& b) {
  if (a.bound != b.bound) return a.bound < b.bound;
  if (a.level != b.level) return a.level > b.level;
  if (a.yaw != b.yaw) return a.yaw > b.yaw;
  return a.x != b.x ? a.x > b.x : a.y > b.y;
}

void CorrelativeMatcher::Rotate(const LikelihoodGrid& grid, Span<const SurfacePoint> points,
                                const SearchWindow& window) {
  count_ = points.size();
  step_yaw_ = YawStep(points, grid.Cell());
  half_yaw_ = static_cast<std::int32_t>(std::ceil(window.reach_yaw / step_yaw_));
  half_ = static_cast<std::int32_t>(std::ceil(window.reach / grid.Cell()));
  cells_.resize(static_cast<std::size_t>(2 * half_yaw_ + 1) * count_ * 2);
  const double x0 = window.guess.x - half_ * grid.Cell() - grid.OriginX();
  const double y0 = window.guess.y - half_ * grid.Cell() - grid.OriginY();
  std::int32_t* to = cells_.data();
  for (std::int32_t i = -half_yaw_; i <= half_yaw_; ++i) {
    const double yaw = window.guess.yaw + i * step_yaw_;
    const double c = std::cos(yaw) / grid.Cell(), s = std::sin(yaw) / grid.Cell();
    for (const SurfacePoint& p : points) {
      const double x = static_cast<double>(p.x), y = static_cast<double>(p.y);
      *to++ = static_cast<std::int32_t>(std::floor(x0 / grid.Cell() + c * x - s * y));
      *to++ = static_cast<std::int32_t>(std::floor(y0 / grid.Cell() + s * x + c * y));
    }
  }
}

// The least over the block.
double CorrelativeMatcher::Penalty(const SearchWindow& window, const Node& node) const {
  const auto outside = [&](std::int32_t first) {
    const std::int32_t last = first + (1 << node.level) - 1;
    return static_cast<double>(first > half_ ? first - half_ : last < half_ ? half_ - last : 0);
  };
  double penalty = 0;
  if (std::isfinite(window.sigma)) {
    const double x = outside(node.x) * cell_ / window.sigma,
                 y = outside(node.y) * cell_ / window.sigma;
    penalty += (x * x + y * y) / 2;
  }
  const double yaw = (node.yaw - half_yaw_) * step_yaw_ / window.sigma_yaw;
  return penalty + yaw * yaw / 2;
}

double CorrelativeMatcher::MeanBound(const LikelihoodGrid& grid, const Node& node, double least) {
  ++visited_;
  const std::int32_t* cell = cells_.data() + static_cast<std::size_t>(node.yaw) * count_ * 2;
  const double full = 255 * static_cast<double>(count_);
  const auto needed = static_cast<std::int64_t>(std::floor(least * full));
  std::int64_t sum = 0;
  for (std::size_t done = 0; done < count_;) {
    const std::size_t until = std::min(done + kBatch, count_);
    for (; done < until; ++done, cell += 2)
      sum +=
          grid.At(node.level, (cell[0] + node.x) >> node.level, (cell[1] + node.y) >> node.level);
    // Not even if all others were hits.
    if (sum + 255 * static_cast<std::int64_t>(count_ - done) < needed) return -1;
  }
  return static_cast<double>(sum) / full;
}

bool CorrelativeMatcher::Search(const LikelihoodGrid& grid, Span<const SurfacePoint> points,
                                const SearchWindow& window, double least_score, Match* best) {
  visited_ = 0;
  if (points.empty()) return false;
  cell_ = grid.Cell();
  Rotate(grid, points, window);
  const double scale = kPointWeight * static_cast<double>(count_);
  const std::int32_t side = 2 * half_ + 1;
  std::int32_t top = 0;
  while (top < LikelihoodGrid::kTopLevel && (2 << top) <= side) ++top;
  heap_.clear();
  const auto push = [&](Node node) {
    const double mean = MeanBound(grid, node, least_score);
    if (mean < least_score) return;
    node.bound = scale * mean - Penalty(window, node);
    heap_.push_back(node);
    std::push_heap(heap_.begin(), heap_.end(), Worse);
  };
  for (std::int32_t yaw = 0; yaw <= 2 * half_yaw_; ++yaw)
    for (std::int32_t y = 0; y < side; y += 1 << top)
      for (std::int32_t x = 0; x < side; x += 1 << top) push({0, yaw, x, y, top});
  while (!heap_.empty()) {
    const Node node = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), Worse);
    heap_.pop_back();
    if (node.level == 0) {
      best->reference_from_scan = {
          window.guess.x + (node.x - half_) * cell_, window.guess.y + (node.y - half_) * cell_,
          WrappedAngle(window.guess.yaw + (node.yaw - half_yaw_) * step_yaw_)};
      best->score = (node.bound + Penalty(window, node)) / scale;
      return true;
    }
    const std::int32_t half_block = 1 << (node.level - 1);
    for (const std::int32_t y : {node.y, node.y + half_block})
      for (const std::int32_t x : {node.x, node.x + half_block})
        if (x < side && y < side) push({0, node.yaw, x, y, node.level - 1});
  }
  return false;
}

std::array<double, 9> CorrelativeMatcher::Covariance(const LikelihoodGrid& grid,
                                                     Span<const SurfacePoint> points,
                                                     const PlanarPose& pose, int cells) {
  cell_ = grid.Cell();
  SearchWindow window;
  window.guess = pose;
  window.reach = cells * cell_;
  window.reach_yaw = cells * YawStep(points, cell_);
  Rotate(grid, points, window);
  const auto at = [&](std::int32_t yaw, std::int32_t y, std::int32_t x) {
    return MeanBound(grid, {0, yaw, x, y, 0}, 0);
  };
  const double scale = kPointWeight * static_cast<double>(count_);
  const double centre = at(half_yaw_, half_, half_);
  double sum = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (std::int32_t yaw = 0; yaw <= 2 * half_yaw_; ++yaw)
    for (std::int32_t y = 0; y <= 2 * half_; ++y)
      for (std::int32_t x = 0; x <= 2 * half_; ++x) {
        const double weight = std::exp(scale * (at(yaw, y, x) - centre));
        const Eigen::Vector3d d((x - half_) * cell_, (y - half_) * cell_,
                                (yaw - half_yaw_) * step_yaw_);
        sum += weight;
        mean += weight * d;
        squares.noalias() += weight * d * d.transpose();
      }
  mean /= sum;
  Eigen::Matrix3d covariance = squares / sum - mean * mean.transpose();
  // Where all but one pose of the grid are unlikely, the grid is what limits it.
  covariance.diagonal() +=
      Eigen::Vector3d(cell_ * cell_, cell_ * cell_, step_yaw_ * step_yaw_) / 12;
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  Eigen::Matrix3d scan_from_reference;
  scan_from_reference << c, s, 0, -s, c, 0, 0, 0, 1;
  covariance = scan_from_reference * covariance * scan_from_reference.transpose().eval();
  std::array<double, 9> rows{};
  for (int i = 0; i < 9; ++i) rows[static_cast<std::size_t>(i)] = covariance(i / 3, i % 3);
  return rows;
}

}  // namespace graticule
