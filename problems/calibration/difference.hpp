#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "graticule/io/image_field.hpp"
#include "graticule/problems/calibration/camera.hpp"
#include "graticule/problems/calibration/gauge.hpp"

namespace graticule {

struct DifferenceOptions {
  std::size_t nodes = 61;  ///< along the longer side of the image
  EreGauge gauge = EreGauge::kRotationCompensated;
  /// Distance of the points that are compared; finite where a translation is taken out.
  double range_m = std::numeric_limits<double>::infinity();
  /// Pixels of the first camera over which the motion is fitted: where corners were seen.  Empty:
  /// all nodes.
  std::vector<Eigen::Vector2d> fitted_on;
};

/// How far two calibrations of one camera are apart.
struct CalibrationDifference {
  ImageField field;                    ///< px; NaN where one of them has no ray or no image
  std::vector<Eigen::Vector2d> shift;  ///< second - first, one a node; NaN as above
  Eigen::Isometry3d second_from_first = Eigen::Isometry3d::Identity();  ///< that was taken out
  std::size_t nodes = 0;                                                ///< that are compared
  std::size_t unseen = 0;  ///< of the first's rays that the second has no image of
  double mean_px = 0, rms_px = 0, percentile_995_px = 0, max_px = 0;
  Eigen::Vector2d max_at = Eigen::Vector2d::Zero();
};

/// Pixels become rays by the first, the rays pixels by the second, after the motion of the second's
/// frame that brings them nearest (least squares): two calibrations that differ by a motion of the
/// frame predict the same images.  mrcal calls it the implied transformation
/// (mrcal.secretsauce.net/differencing.html).
///
/// Throws Error (kUsage): images of different sizes, a translation without a finite range.
CalibrationDifference Difference(const Camera& first, const Camera& second,
                                 const DifferenceOptions& options = {});

}  // namespace graticule
