#include "graticule/problems/calibration/gauge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "graticule/solver/error.hpp"

namespace graticule {

namespace {
constexpr EreGauge kGauges[] = {EreGauge::kRaw, EreGauge::kRotationCompensated,
                                EreGauge::kMotionCompensated};
}

const char* NameOf(EreGauge gauge) {
  switch (gauge) {
    case EreGauge::kRaw:
      return "raw";
    case EreGauge::kRotationCompensated:
      return "rotation_compensated";
    case EreGauge::kMotionCompensated:
      break;
  }
  return "motion_compensated";
}

EreGauge EreGaugeOf(std::string_view name) {
  std::string names;
  for (const EreGauge gauge : kGauges) {
    if (name == NameOf(gauge)) return gauge;
    names += std::string(names.empty() ? "" : ", ") + NameOf(gauge);
  }
  throw Error("no gauge is called '" + std::string(name) + "'; there are " + names,
              ErrorKind::kUsage);
}

MovingPixel MovingPixelAt(const Camera& camera, const Eigen::Vector2d& pixel) {
  MovingPixel moving;
  moving.pixel = pixel;
  const auto ray = camera.Unproject(pixel);
  if (!ray) return moving;
  const int size = camera.Model().parameters;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> by_parameters(2, size);
  if (!camera.Project(*ray, by_point.data(), by_parameters.data())) return moving;
  moving.ray = *ray;
  moving.by_parameters = by_parameters;
  for (int row = 0; row < 2; ++row)
    moving.by_motion.row(row).head<3>() =
        ray->cross(Eigen::Vector3d(by_point.row(row).transpose())).transpose();
  moving.by_motion.rightCols<3>() = by_point;
  return moving;
}

std::vector<MovingPixel> MovingPixels(const Camera& camera, int columns, int rows) {
  if (columns < 2 || rows < 2)
    throw Error("expected a grid of two by two pixels or more", ErrorKind::kUsage);
  std::vector<MovingPixel> pixels;
  pixels.reserve(static_cast<std::size_t>(columns * rows));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      pixels.push_back(MovingPixelAt(camera, {(camera.Width() - 1.) * column / (columns - 1),
                                              (camera.Height() - 1.) * row / (rows - 1)}));
  return pixels;
}

Eigen::MatrixXd ImpliedMotion(const std::vector<MovingPixel>& pixels, EreGauge gauge) {
  Eigen::Index size = 0;
  for (const MovingPixel& pixel : pixels) size = std::max(size, pixel.by_parameters.cols());
  Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(6, size);
  const Eigen::Index count = gauge == EreGauge::kRaw                   ? 0
                             : gauge == EreGauge::kRotationCompensated ? 3
                                                                       : 6;
  Eigen::Matrix<double, 6, 6> sums = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::MatrixXd by_parameters = Eigen::MatrixXd::Zero(6, size);
  for (const MovingPixel& pixel : pixels) {
    if (!pixel.HasRay()) continue;
    sums += pixel.by_motion.transpose() * pixel.by_motion;
    by_parameters += pixel.by_motion.transpose() * pixel.by_parameters;
  }
  if (count == 0 || sums.isZero()) return motion;
  motion.topRows(count) =
      sums.topLeftCorner(count, count).ldlt().solve(by_parameters.topRows(count));
  return motion;
}

}  // namespace graticule
