#include "graticule/problems/calibration/difference.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// What is compared: a pixel of the first camera and a point there, in its frame.
struct Compared {
  Eigen::Vector2d pixel;
  Eigen::Vector3d point;
};

std::vector<Compared> PointsAt(const Camera& camera, const std::vector<Eigen::Vector2d>& pixels,
                               double range_m) {
  std::vector<Compared> points;
  for (const Eigen::Vector2d& pixel : pixels)
    if (const auto ray = camera.Unproject(pixel))
      points.push_back({pixel, std::isfinite(range_m) ? Eigen::Vector3d(range_m * *ray) : *ray});
  return points;
}

// The rotation between the rays that both give to the pixels (Kabsch 1976): where to begin.
Eigen::Matrix3d RotationOfRays(const Camera& second, const std::vector<Compared>& points) {
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  for (const Compared& point : points)
    if (const auto ray = second.Unproject(point.pixel))
      sums += *ray * point.point.normalized().transpose();
  if (sums.isZero()) return Eigen::Matrix3d::Identity();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sums, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

struct Fit {
  double cost = 0;        // sum of squares of those that have an image
  std::size_t count = 0;  // of them
  Eigen::Matrix<double, 6, 6> sums = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> slope = Eigen::Matrix<double, 6, 1>::Zero();

  // Comparable between motions that see different numbers of points.
  double Mean() const { return count == 0 ? HUGE_VAL : cost / static_cast<double>(count); }
};

// The motion's tangent is [rotation, translation], on the second's side.
Fit Evaluate(const Camera& second, const std::vector<Compared>& points,
             const Eigen::Isometry3d& motion) {
  Fit fit;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  for (const Compared& point : points) {
    const Eigen::Vector3d moved = motion * point.point;
    const auto pixel = second.Project(moved, by_point.data(), nullptr);
    if (!pixel) continue;
    const Eigen::Vector2d off = *pixel - point.pixel;
    Eigen::Matrix<double, 2, 6> j;
    for (int row = 0; row < 2; ++row)
      j.row(row).head<3>() =
          moved.cross(Eigen::Vector3d(by_point.row(row).transpose())).transpose();
    j.rightCols<3>() = by_point;
    fit.cost += off.squaredNorm();
    ++fit.count;
    fit.sums += j.transpose() * j;
    fit.slope += j.transpose() * off;
  }
  return fit;
}

Eigen::Isometry3d Moved(const Eigen::Isometry3d& motion, const Eigen::VectorXd& step) {
  const Eigen::Vector3d turn = step.head<3>();
  Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0)
    by.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  if (step.size() == 6) by.translation() = step.tail<3>();
  return by * motion;
}

// Levenberg-Marquardt.
Eigen::Isometry3d ImpliedMotionOf(const Camera& second, const std::vector<Compared>& points,
                                  Eigen::Index freedoms) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (freedoms == 0 || points.size() < 3) return motion;
  motion.linear() = RotationOfRays(second, points);
  Fit fit = Evaluate(second, points, motion);
  double damping = 1e-6;
  for (int i = 0; i < 100 && damping < 1e12; ++i) {
    Eigen::MatrixXd sums = fit.sums.topLeftCorner(freedoms, freedoms);
    sums.diagonal() *= 1 + damping;
    const Eigen::VectorXd step = -sums.ldlt().solve(fit.slope.head(freedoms));
    if (!step.allFinite()) break;
    const Eigen::Isometry3d next = Moved(motion, step);
    const Fit there = Evaluate(second, points, next);
    if (!(there.Mean() < fit.Mean())) {
      damping *= 10;
      continue;
    }
    const bool done = there.Mean() > fit.Mean() * (1 - 1e-14);
    motion = next;
    fit = there;
    damping = std::max(damping / 10, 1e-12);
    if (done) break;
  }
  return motion;
}

Eigen::Index FreedomsOf(const DifferenceOptions& options) {
  if (options.gauge == EreGauge::kRaw) return 0;
  if (options.gauge == EreGauge::kRotationCompensated) return 3;
  if (!std::isfinite(options.range_m))
    throw Error("difference: a translation needs points at a finite range", ErrorKind::kUsage);
  return 6;
}

void Summarise(CalibrationDifference* difference) {
  std::vector<double> distances;
  for (const double value : difference->field.values)
    if (std::isfinite(value)) distances.push_back(value);
  difference->nodes = distances.size();
  if (distances.empty()) return;
  std::sort(distances.begin(), distances.end());
  const auto count = static_cast<double>(distances.size());
  difference->mean_px = std::accumulate(distances.begin(), distances.end(), 0.0) / count;
  difference->rms_px = std::sqrt(
      std::inner_product(distances.begin(), distances.end(), distances.begin(), 0.0) / count);
  difference->percentile_995_px = distances[static_cast<std::size_t>(0.995 * (count - 1))];
  difference->max_px = distances.back();
}

}  // namespace

CalibrationDifference Difference(const Camera& first, const Camera& second,
                                 const DifferenceOptions& options) {
  if (first.Width() != second.Width() || first.Height() != second.Height())
    throw Error("difference: images of " + std::to_string(first.Width()) + " x " +
                    std::to_string(first.Height()) + " and of " + std::to_string(second.Width()) +
                    " x " + std::to_string(second.Height()) + " pixels cannot be compared",
                ErrorKind::kUsage);
  if (!(options.range_m > 0))
    throw Error("difference: expected a range above zero", ErrorKind::kUsage);
  const Eigen::Index freedoms = FreedomsOf(options);
  CalibrationDifference difference;
  ImageField& field = difference.field;
  field = EmptyField(first.Width(), first.Height(), std::max<std::size_t>(options.nodes, 2));
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t r = 0; r < field.rows; ++r)
    for (std::size_t c = 0; c < field.columns; ++c)
      pixels.emplace_back(field.At(c, r).x, field.At(c, r).y);
  difference.second_from_first = ImpliedMotionOf(
      second,
      PointsAt(first, options.fitted_on.empty() ? pixels : options.fitted_on, options.range_m),
      freedoms);

  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const Eigen::Vector2d& pixel : pixels) {
    field.values.push_back(kNone);
    difference.shift.emplace_back(kNone, kNone);
    const auto point = PointsAt(first, {pixel}, options.range_m);
    if (point.empty()) continue;
    const auto image = second.Project(difference.second_from_first * point[0].point);
    if (!image) {
      ++difference.unseen;
      continue;
    }
    difference.shift.back() = *image - pixel;
    field.values.back() = difference.shift.back().norm();
    if (field.values.back() > difference.max_px) {
      difference.max_px = field.values.back();
      difference.max_at = pixel;
    }
  }
  Summarise(&difference);
  return difference;
}

}  // namespace graticule
