// DescribeCalibration of picture_data.hpp: the pieces put together.

#include <algorithm>
#include <cmath>

#include "graticule/io/readable.hpp"
#include "graticule/problems/calibration/advice.hpp"
#include "graticule/problems/calibration/picture_data.hpp"

namespace graticule {
namespace {

// How well it explains what it was made from.
ReportedError FitOf(const Detections& detections, const Calibration& calibration) {
  std::vector<double> distances;
  ReprojectionError error;
  for (std::size_t v = 0; v < detections.views.size(); ++v) {
    const std::vector<Eigen::Vector2d> off = ViewResiduals(calibration.state, detections.views[v]);
    const bool all = calibration.use.empty() || calibration.use[v].empty();
    const std::size_t before = distances.size();
    for (std::size_t i = 0; i < off.size(); ++i)
      if ((all || calibration.use[v][i]) && off[i].allFinite()) distances.push_back(off[i].norm());
    error.views += distances.size() > before;
  }
  const std::size_t views = error.views;
  if (!distances.empty()) error = SummariseErrors(&distances);
  error.views = views;
  return DescribeError("fit", error);
}

std::string Count(std::size_t count, const char* one, const char* many) {
  return ReadableCount(count) + " " + (count == 1 ? one : many);
}

}  // namespace

CalibrationReport DescribeCalibration(const Detections& detections, const ModelSelection& selection,
                                      const DescribeOptions& options) {
  const Calibration& solved = selection.calibration;
  CalibrationReport report;
  report.title = "Calibration of";
  for (const ImageSize& camera : detections.cameras) report.title += " " + camera.camera;
  report.accuracy_px = options.accuracy_px;
  report.facts = {
      {"views", Count(detections.views.size(), "view", "views") + " in " +
                    Count(detections.exposures, "exposure", "exposures")},
      {"corners", Count(solved.corners, "corner counts", "corners count") + ", " +
                      Count(solved.outliers.size(), "was set aside", "were set aside")},
      {"model", selection.options.model},
      {"board", BoardShapeName(selection.options.board)},
      {"noise", ReadableNumber(solved.sigma_px, 3) + " px on either axis, from the residuals"}};
  if (!solved.left_out.empty())
    report.warnings.push_back(Count(solved.left_out.size(), "view", "views") +
                              " left out: no pose of the target explains " +
                              (solved.left_out.size() == 1 ? "it" : "them"));
  report.errors.push_back(FitOf(detections, solved));
  if (selection.chosen < selection.trials.size())
    report.errors.push_back(DescribeError("held out", selection.trials[selection.chosen].held_out));
  double worst = kNotKnown;
  for (std::size_t c = 0; c < solved.state.cameras.size(); ++c) {
    report.cameras.push_back(DescribeCamera(detections, solved, c, options));
    worst = std::fmax(worst, report.cameras.back().max_ere_px);
  }
  const bool constrained = !options.posterior || options.posterior->Constrained();
  const bool met = options.accuracy_px <= 0 || worst <= options.accuracy_px;
  report.verdict = !constrained ? CalibrationVerdict::kUnconstrained
                   : met        ? CalibrationVerdict::kMet
                                : CalibrationVerdict::kNotMet;
  if (options.posterior) report.unconstrained = options.posterior->unconstrained;
  if (report.verdict != CalibrationVerdict::kMet)
    for (std::size_t c = 0; c < solved.state.cameras.size(); ++c)
      for (std::string& advice : AdviseViews(detections, solved.state, c, options.posterior))
        report.advice.push_back(solved.state.cameras.size() > 1
                                    ? solved.state.cameras[c].name + ": " + advice
                                    : std::move(advice));
  report.board = DescribeBoard(detections, solved.state);
  DescribeSelection(selection, &report);
  return report;
}

}  // namespace graticule
