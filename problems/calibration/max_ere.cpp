#include "graticule/problems/calibration/max_ere.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Complete elliptic integral of the second kind of parameter 1 - r^2 by the arithmetic-geometric
// mean (Abramowitz and Stegun, 17.6).
double EllipticSecond(double ratio) {
  if (ratio < 1e-9) return 1;
  double a = 1, b = ratio, sum = (1 - ratio * ratio) / 2, power = 0.5;
  while (a - b > 1e-15 * a) {
    const double c = (a - b) / 2, mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
    power *= 2;
    sum += power * c * c;
  }
  return M_PI / (2 * a) * (1 - sum);
}

// A model whose frame is moved: points at a range, in the first model's frame, to pixels.
struct MovedModel {
  const CameraModel* model;
  const double* parameters;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  double range = 1;

  bool Project(const Eigen::Vector3d& ray, Eigen::Vector2d* pixel, double* by_point) const {
    const Eigen::Vector3d point = motion * (range * ray);
    return model->project(parameters, point.data(), pixel->data(), by_point, nullptr);
  }
};

// Brings the pixels nearest to where they were, by the gauge's motion.
void FitMotion(const std::vector<MovingPixel>& pixels, EreGauge gauge, MovedModel* moved) {
  if (gauge == EreGauge::kRaw) return;
  const int size = gauge == EreGauge::kRotationCompensated ? 3 : 6;
  constexpr int kIterations = 10;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix<double, 6, 6> sums = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    for (const MovingPixel& pixel : pixels) {
      Eigen::Vector2d now;
      Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
      if (!pixel.HasRay() || !moved->Project(pixel.ray, &now, by_point.data())) continue;
      const Eigen::Vector3d turned = moved->range * (moved->motion.linear() * pixel.ray);
      Eigen::Matrix<double, 2, 6> j;
      for (int row = 0; row < 2; ++row)
        j.row(row).head<3>() = turned.cross(Eigen::Vector3d(by_point.row(row).transpose()));
      j.rightCols<3>() = moved->range * by_point;
      sums += j.transpose() * j;
      gradient += j.transpose() * (now - pixel.pixel);
    }
    if (!(sums.diagonal().head(size).minCoeff() > 0)) return;
    const Eigen::VectorXd step = -sums.topLeftCorner(size, size).ldlt().solve(gradient.head(size));
    if (!step.allFinite()) return;
    const Eigen::Vector3d turn = step.head<3>();
    const double angle = turn.norm();
    if (angle > 0)
      moved->motion.linear() =
          Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * moved->motion.linear();
    if (size == 6) moved->motion.translation() += moved->range * step.tail<3>();
    if (step.norm() < 1e-12) return;
  }
}

EreMap EmptyMap(const std::vector<MovingPixel>& pixels, const EreOptions& options) {
  EreMap map{options.columns, options.rows, {}};
  for (const MovingPixel& pixel : pixels)
    map.points.push_back({pixel.pixel, pixel.HasRay(), true, 0});
  return map;
}

// Points so far away that a translation cannot be told are not asked for one.
std::vector<MovingPixel> GaugePixels(const Camera& camera, const EreOptions& options) {
  if (options.gauge_pixels.empty())
    return MovingPixels(camera, options.gauge_columns, options.gauge_rows);
  std::vector<MovingPixel> pixels;
  for (const Eigen::Vector2d& pixel : options.gauge_pixels)
    pixels.push_back(MovingPixelAt(camera, pixel));
  return pixels;
}

EreGauge GaugeOf(const EreOptions& options) {
  return options.gauge == EreGauge::kMotionCompensated && !std::isfinite(options.range_m)
             ? EreGauge::kRotationCompensated
             : options.gauge;
}

double RangeOf(const EreOptions& options) {
  return std::isfinite(options.range_m) ? options.range_m : 1;
}

// Adds each pixel's distance between where it was and where the model sees its ray.
void AddDistances(const std::vector<MovingPixel>& pixels, const MovedModel& moved, double weight,
                  EreMap* map) {
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i].HasRay()) continue;
    Eigen::Vector2d now;
    map->points[i].ere_px += moved.Project(pixels[i].ray, &now, nullptr)
                                 ? weight * (now - pixels[i].pixel).norm()
                                 : kInfinity;
  }
}

// A root of a matrix that may be singular; scaled, since units differ.
Eigen::MatrixXd RootOf(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(inverse.asDiagonal() * covariance *
                                                             inverse.asDiagonal());
  return scale.asDiagonal() * eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

std::vector<double> Draw(const Camera& camera, const Eigen::MatrixXd& root, RandomNumbers* random) {
  Eigen::VectorXd normal(root.cols());
  for (double& value : normal) value = random->Normal();
  std::vector<double> parameters = camera.Intrinsics().parameters;
  Eigen::Map<Eigen::VectorXd>(parameters.data(), root.rows()) += root * normal;
  return parameters;
}

}  // namespace

double ExpectedLength(const Eigen::Matrix2d& covariance) {
  const double half = (covariance(0, 0) + covariance(1, 1)) / 2;
  const double difference = (covariance(0, 0) - covariance(1, 1)) / 2;
  const double radius = std::hypot(difference, (covariance(0, 1) + covariance(1, 0)) / 2);
  const double larger = half + radius;
  if (!(larger > 0)) return 0;
  const double ratio = std::sqrt(std::max(0., half - radius) / larger);
  return std::sqrt(2 / M_PI * larger) * EllipticSecond(ratio);
}

const ErePoint* EreMap::Worst() const {
  const ErePoint* worst = nullptr;
  for (const ErePoint& point : points)
    if (point.has_ray && (!worst || point.ere_px > worst->ere_px)) worst = &point;
  return worst;
}

double EreMap::MaxPx() const {
  const ErePoint* worst = Worst();
  return worst ? worst->ere_px : 0;
}

EreGrid::EreGrid(const Camera& camera, const EreOptions& options)
    : columns_(options.columns), rows_(options.rows) {
  const std::vector<MovingPixel> pixels = MovingPixels(camera, columns_, rows_);
  const EreGauge gauge = GaugeOf(options);
  Eigen::MatrixXd motion;
  if (gauge != EreGauge::kRaw) motion = ImpliedMotion(GaugePixels(camera, options), gauge);
  by_parameters_.resize(2 * static_cast<Eigen::Index>(pixels.size()), camera.Model().parameters);
  Eigen::Index row = 0;
  for (const MovingPixel& pixel : pixels) {
    pixels_.push_back(pixel.pixel);
    has_ray_.push_back(pixel.HasRay());
    if (!pixel.HasRay()) continue;
    by_parameters_.middleRows<2>(row) = pixel.by_parameters;
    if (gauge != EreGauge::kRaw) by_parameters_.middleRows<2>(row) -= pixel.by_motion * motion;
    row += 2;
  }
  by_parameters_.conservativeResize(row, Eigen::NoChange);
}

EreMap EreGrid::Map(const Eigen::MatrixXd& covariance) const {
  EreMap map{columns_, rows_, {}};
  const Eigen::MatrixXd half = by_parameters_ * covariance;
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    map.points.push_back({pixels_[i], has_ray_[i] != 0, true, 0});
    if (!has_ray_[i]) continue;
    map.points.back().ere_px =
        ExpectedLength(half.middleRows<2>(row) * by_parameters_.middleRows<2>(row).transpose());
    row += 2;
  }
  return map;
}

double EreGrid::MaxPx(const Eigen::MatrixXd& covariance) const {
  const Eigen::MatrixXd half = by_parameters_ * covariance;
  double most = 0;
  for (Eigen::Index row = 0; row < half.rows(); row += 2) {
    const Eigen::Matrix2d at =
        half.middleRows<2>(row) * by_parameters_.middleRows<2>(row).transpose();
    // The expected length is at most the root of the trace.
    if (at.trace() > most * most) most = std::max(most, ExpectedLength(at));
  }
  return most;
}

std::optional<double> EreAt(const Camera& camera, const Eigen::MatrixXd& covariance,
                            const Eigen::Vector2d& pixel, const EreOptions& options) {
  const MovingPixel moving = MovingPixelAt(camera, pixel);
  if (!moving.HasRay()) return std::nullopt;
  Eigen::MatrixXd by_parameters = moving.by_parameters;
  if (const EreGauge gauge = GaugeOf(options); gauge != EreGauge::kRaw)
    by_parameters -= moving.by_motion * ImpliedMotion(GaugePixels(camera, options), gauge);
  return ExpectedLength(by_parameters * covariance * by_parameters.transpose());
}

EreMap SampledEre(const Camera& camera, const Eigen::MatrixXd& covariance,
                  const EreOptions& options, int samples, std::uint64_t seed) {
  const CameraModel& model = camera.Model();
  if (samples < 1) throw Error("expected one sample or more", ErrorKind::kUsage);
  const std::vector<MovingPixel> pixels = MovingPixels(camera, options.columns, options.rows);
  const std::vector<MovingPixel> gauge = GaugePixels(camera, options);
  const Eigen::MatrixXd root = RootOf(covariance);
  EreMap map = EmptyMap(pixels, options);
  RandomNumbers random(seed);
  for (int i = 0; i < samples; ++i) {
    const std::vector<double> parameters = Draw(camera, root, &random);
    MovedModel moved{&model, parameters.data(), Eigen::Isometry3d::Identity(), RangeOf(options)};
    FitMotion(gauge, GaugeOf(options), &moved);
    AddDistances(pixels, moved, 1. / samples, &map);
  }
  return map;
}

std::vector<double> DrawnParameters(const Camera& camera, const Eigen::MatrixXd& covariance,
                                    RandomNumbers* random) {
  return Draw(camera, RootOf(covariance), random);
}

void MarkReached(const Detections& detections, std::size_t camera, const CornerUse& use,
                 EreMap* map, double near) {
  if (camera >= detections.cameras.size())
    throw Error("no such camera among the detections", ErrorKind::kUsage);
  const double reach =
      near * std::hypot(detections.cameras[camera].width, detections.cameras[camera].height);
  // Corners by square cells as wide as the reach: what is near is in nine of them.
  using Cell = std::pair<long, long>;
  const auto cell_of = [&](double u, double v) {
    return Cell(std::lround(u / reach), std::lround(v / reach));
  };
  std::map<Cell, std::vector<Eigen::Vector2d>> cells;
  for (std::size_t i = 0; i < detections.views.size(); ++i) {
    const TargetView& view = detections.views[i];
    if (view.camera != camera) continue;
    for (std::size_t j = 0; j < view.corners.size(); ++j) {
      if (!use.empty() && !use[i].empty() && !use[i][j]) continue;
      const auto& pixel = view.corners[j].pixel;
      cells[cell_of(pixel[0], pixel[1])].emplace_back(pixel[0], pixel[1]);
    }
  }
  for (ErePoint& point : map->points) {
    point.is_reached = false;
    const Cell at = cell_of(point.pixel.x(), point.pixel.y());
    for (long i = -1; i <= 1 && !point.is_reached; ++i)
      for (long j = -1; j <= 1 && !point.is_reached; ++j) {
        const auto cell = cells.find({at.first + i, at.second + j});
        if (cell == cells.end()) continue;
        point.is_reached = std::any_of(
            cell->second.begin(), cell->second.end(),
            [&](const Eigen::Vector2d& c) { return (c - point.pixel).norm() <= reach; });
      }
  }
}

std::vector<Eigen::Vector2d> SeenPixels(const Detections& detections, std::size_t camera,
                                        const CornerUse& use, std::size_t most) {
  std::vector<Eigen::Vector2d> all;
  for (std::size_t i = 0; i < detections.views.size(); ++i) {
    const TargetView& view = detections.views[i];
    if (view.camera != camera) continue;
    for (std::size_t j = 0; j < view.corners.size(); ++j)
      if (use.empty() || use[i].empty() || use[i][j])
        all.emplace_back(view.corners[j].pixel[0], view.corners[j].pixel[1]);
  }
  if (all.size() <= most) return all;
  std::vector<Eigen::Vector2d> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

}  // namespace graticule
