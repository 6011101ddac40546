#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "graticule/io/calibration_report.hpp"
#include "graticule/problems/calibration/difference.hpp"
#include "graticule/problems/calibration/evaluate.hpp"
#include "graticule/problems/calibration/max_ere.hpp"
#include "graticule/problems/calibration/placement.hpp"
#include "graticule/problems/calibration/posterior.hpp"
#include "graticule/problems/calibration/select_model.hpp"

namespace graticule {

/// An image that a camera took.
struct ShownImage {
  GreyImage image;
  std::string view;  ///< TargetView::image of what was seen in it; "": of no view
};

struct DescribeOptions {
  const Posterior* posterior = nullptr;  ///< null: no deviations, no expected errors
  double accuracy_px = 0;                ///< asked for; 0: nothing was
  std::vector<double> held_out_px;       ///< mean error by exposure (CrossValidate), or empty
  /// Gauge and range of the number that counts.  Without gauge_pixels, where corners were seen.
  EreOptions ere;
  /// By camera, for the pictures before and after undistortion; without one they show a grid.
  std::vector<std::optional<ShownImage>> images;
};

/// Everything that a report says of one camera: numbers, views, residuals, coverage, the distortion
/// curve, expected errors (the gauge asked for, then raw) with their cross section, and the
/// undistortion.
CameraReport DescribeCamera(const Detections& detections, const Calibration& calibration,
                            std::size_t camera, const DescribeOptions& options = {});

/// A whole report of a selected model: facts, verdict, advice (AdviseViews), errors, cameras,
/// board, models.  Timings, a suggested pose and what else is known are the caller's to add.
CalibrationReport DescribeCalibration(const Detections& detections, const ModelSelection& selection,
                                      const DescribeOptions& options);

/// A map of expected errors.
ErrorMap DescribeEre(const EreMap& map, const Camera& camera, const EreOptions& options,
                     double accuracy_px);

/// Expected errors from the centre to the image's farthest corner: with the frame's rotation taken
/// out, and as they are.  `covariance` of the camera's parameters.
CrossSection DescribeSection(const Camera& camera, const Eigen::MatrixXd& covariance,
                             const EreOptions& options);
/// How far out along the section corners were seen [px].
double SeenAlongSection(const Detections& detections, std::size_t camera, const Camera& model);

/// A difference as a map; `name` of what was compared.
ErrorMap DescribeDifference(const CalibrationDifference& difference, const std::string& name,
                            double limit_px = 0);
/// Its values along the section, as another curve of it.
Curve SectionOf(const CalibrationDifference& difference, const Camera& first,
                const std::string& name);

/// Corners, outlines of views and rings of equal angle from the optical axis.
CoveragePicture DescribeCoverage(const Detections& detections, std::size_t camera,
                                 const Camera& model);

/// Radius over angle; `covariance` of the parameters, or empty.
DistortionCurve DescribeDistortion(const Camera& camera, const Eigen::MatrixXd& covariance);

/// Before and after: the image, if there is one, else a grid; and rows of corners of the views (of
/// those that reach farthest, or the image's), with how far they are from straight lines.
UndistortionPicture DescribeUndistortion(const Detections& detections, std::size_t camera,
                                         const Camera& model,
                                         const std::optional<ShownImage>& image = std::nullopt);

/// The view of a camera whose corners lie farthest from its centre, into Detections::views: whose
/// image shows best what the lens does.  None without corners.
std::optional<std::size_t> FarthestView(const Detections& detections, std::size_t camera,
                                        const Camera& model);

/// Where corners are against the target's description, after the best rigid motion; none of a flat
/// target, or where its corners are not in one plane.
std::optional<BoardPicture> DescribeBoard(const Detections& detections,
                                          const CalibrationState& state);

/// Quads of a target's tags, or of a chessboard's squares between its corners, from the corners
/// that are seen; `names`, unless null, gets one number a quad.
std::vector<ImageLine> QuadsOf(const TargetLayout& target,
                               const std::vector<DetectedCorner>& corners,
                               std::vector<int>* names = nullptr);

TriedModel DescribeTrial(const ModelTrial& trial, bool chosen);
/// Shapes and models of a selection, into a report.
void DescribeSelection(const ModelSelection& selection, CalibrationReport* report);
ReportedError DescribeError(const std::string& name, const ReprojectionError& error);

}  // namespace graticule
