#include "graticule/problems/segmentation/coregister_error.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>

#include "graticule/factors/lie.hpp"
#include "graticule/problems/calibration/max_ere.hpp"
#include "graticule/problems/calibration/state.hpp"

namespace graticule {
namespace {

using PixelRows = Eigen::Matrix<double, 2, 6>;

// What the extrinsics' tangent does to the pixel of a point on a ray, and the point's own error.
struct Sight {
  PixelRows by_extrinsics;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
};

std::optional<Sight> SightAt(const Camera& camera, const Eigen::Isometry3d& camera_from_lidar,
                             const ImagePoint& pixel, double range_m) {
  const auto ray = camera.Unproject({pixel.x, pixel.y});
  if (!ray) return std::nullopt;
  const Eigen::Vector3d in_camera = range_m * *ray;
  const Eigen::Vector3d in_lidar = camera_from_lidar.inverse() * in_camera;
  Sight sight;
  if (!camera.Project(in_camera, sight.by_point.data(), nullptr)) return std::nullopt;
  sight.by_extrinsics.leftCols<3>() = sight.by_point * camera_from_lidar.linear();
  sight.by_extrinsics.rightCols<3>() = -sight.by_extrinsics.leftCols<3>() * Skew(in_lidar);
  return sight;
}

double Largest(const std::vector<PixelRows>& sights, const Matrix6& covariance) {
  double most = 0;
  for (const PixelRows& sight : sights)
    most = std::max(most, ExpectedLength(sight * covariance * sight.transpose()));
  return most;
}

}  // namespace

std::vector<ExtrinsicError> ExpectedErrors(const Camera& camera, const Se3Array& camera_from_lidar,
                                           const Matrix6& covariance,
                                           const std::vector<double>& ranges_m, std::size_t nodes) {
  const Eigen::Isometry3d pose = IsometryOf(camera_from_lidar);
  std::vector<ExtrinsicError> errors;
  for (const double range : ranges_m) {
    ExtrinsicError error;
    error.range_m = range;
    error.field = EmptyField(camera.Width(), camera.Height(), nodes);
    for (std::size_t row = 0; row < error.field.rows; ++row)
      for (std::size_t column = 0; column < error.field.columns; ++column) {
        const ImagePoint at = error.field.At(column, row);
        const auto sight = SightAt(camera, pose, at, range);
        double expected = std::numeric_limits<double>::quiet_NaN();
        if (sight)
          expected =
              ExpectedLength(sight->by_extrinsics * covariance * sight->by_extrinsics.transpose());
        error.field.values.push_back(expected);
        if (expected > error.max_px) {
          error.max_px = expected;
          error.max_at = at;
        }
      }
    errors.push_back(std::move(error));
  }
  return errors;
}

NextCorrespondence SuggestCorrespondence(const Camera& camera, const Coregistration& solved,
                                         const CoregisterOptions& options,
                                         const std::vector<double>& ranges_m) {
  const Eigen::Isometry3d pose = IsometryOf(solved.state.camera_from_lidar);
  const ImageField grid = EmptyField(camera.Width(), camera.Height(), 11);
  struct Candidate {
    ImagePoint pixel;
    double range_m;
    Sight sight;
  };
  std::vector<Candidate> candidates;
  std::vector<PixelRows> sights;
  for (const double range : ranges_m)
    for (std::size_t row = 0; row < grid.rows; ++row)
      for (std::size_t column = 0; column < grid.columns; ++column) {
        const ImagePoint at = grid.At(column, row);
        const auto sight = SightAt(camera, pose, at, range);
        if (!sight) continue;
        candidates.push_back({at, range, *sight});
        sights.push_back(sight->by_extrinsics);
      }
  const Matrix6 information = solved.covariance.inverse();
  NextCorrespondence next;
  next.max_px_before = Largest(sights, solved.covariance);
  next.max_px = next.max_px_before;
  for (const Candidate& candidate : candidates) {
    const Eigen::Matrix2d noise =
        solved.scale * solved.scale *
        (options.sigma_px * options.sigma_px * Eigen::Matrix2d::Identity() +
         options.sigma_m * options.sigma_m * candidate.sight.by_point *
             candidate.sight.by_point.transpose());
    const PixelRows& j = candidate.sight.by_extrinsics;
    const Matrix6 with = information + j.transpose() * noise.inverse() * j;
    const double largest = Largest(sights, with.ldlt().solve(Matrix6::Identity()));
    if (largest < next.max_px) {
      next.max_px = largest;
      next.pixel = candidate.pixel;
      next.range_m = candidate.range_m;
    }
  }
  return next;
}

}  // namespace graticule
