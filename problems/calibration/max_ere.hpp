#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "graticule/problems/calibration/calibrate.hpp"
#include "graticule/problems/calibration/gauge.hpp"
#include "graticule/problems/random.hpp"

namespace graticule {

/// Expected length of a Gaussian vector of mean 0 in the plane, exactly: sqrt(2/pi) a E(1 -
/// b^2/a^2) with standard deviations a >= b along its axes and the complete elliptic integral of
/// the second kind E.  (In polar coordinates the length is Rayleigh's, of mean sqrt(pi/2), times
/// sqrt(a^2 cos^2 + b^2 sin^2), whose mean over the circle is 2 a E / pi.)
double ExpectedLength(const Eigen::Matrix2d& covariance);

struct EreOptions {
  /// Where the error is looked for; the outermost pixels are the image's very corners.
  int columns = 5, rows = 5;
  EreGauge gauge = EreGauge::kRotationCompensated;
  /// Distance of the points that are projected.  Without translation it does not matter: a camera
  /// sees rays.
  double range_m = std::numeric_limits<double>::infinity();
  /// The pixels over which the gauge's motion is fitted.
  int gauge_columns = 9, gauge_rows = 7;
  /// If set, the pixels over which it is fitted instead: where corners were seen (SeenPixels), so
  /// that what nobody knows of the image's corners turns no frame.
  std::vector<Eigen::Vector2d> gauge_pixels;
};

/// Expected reprojection error at a pixel.
struct ErePoint {
  Eigen::Vector2d pixel;
  bool has_ray = false;    ///< else nothing is expected: the corner of a circular image
  bool is_reached = true;  ///< a target's corner was seen near here: MarkReached
  double ere_px = 0;
};

/// Expected reprojection error over the image, row by row.
struct EreMap {
  int columns = 0, rows = 0;
  std::vector<ErePoint> points;

  /// The largest, Max ERE (thesis, section 5.2.1); null if no pixel has a ray.
  const ErePoint* Worst() const;
  /// The largest, 0 without any.
  double MaxPx() const;
};

/// Max ERE in closed form: pixels move linearly with the parameters, and the expected length of
/// what a Gaussian makes of it is exact.  Computed once for a camera, then for many covariances.
class EreGrid {
 public:
  EreGrid(const Camera& camera, const EreOptions& options = {});

  /// Of the covariance of the camera's parameters.
  EreMap Map(const Eigen::MatrixXd& covariance) const;
  double MaxPx(const Eigen::MatrixXd& covariance) const;
  /// What a change of the parameters does to the pixels, the gauge's motion taken out: two rows a
  /// pixel, those without a ray left out.
  const Eigen::MatrixXd& ByParameters() const { return by_parameters_; }

 private:
  int columns_, rows_;
  std::vector<Eigen::Vector2d> pixels_;
  std::vector<std::uint8_t> has_ray_;
  Eigen::MatrixXd by_parameters_;
};

/// Expected error at one pixel, in closed form; none where it has no ray.
std::optional<double> EreAt(const Camera& camera, const Eigen::MatrixXd& covariance,
                            const Eigen::Vector2d& pixel, const EreOptions& options = {});

/// Algorithm 5.1: parameters drawn from their distribution, points projected through them, the
/// gauge's motion fitted to each draw, the mean of the distances.  A point that a draw has no image
/// of has an infinite error.  Same seed, same digits.
EreMap SampledEre(const Camera& camera, const Eigen::MatrixXd& covariance,
                  const EreOptions& options, int samples, std::uint64_t seed);

/// Parameters drawn from a Gaussian around the camera's.
std::vector<double> DrawnParameters(const Camera& camera, const Eigen::MatrixXd& covariance,
                                    RandomNumbers* random);

/// Says which pixels had a counted corner of a view of this camera nearer than `near` image
/// diagonals.  Elsewhere an expected error is an extrapolation.
void MarkReached(const Detections& detections, std::size_t camera, const CornerUse& use,
                 EreMap* map, double near = 0.08);

/// Pixels of at most `most` counted corners of a camera, evenly through its views.
std::vector<Eigen::Vector2d> SeenPixels(const Detections& detections, std::size_t camera,
                                        const CornerUse& use, std::size_t most = 200);

}  // namespace graticule
