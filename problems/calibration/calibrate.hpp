#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/options.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

/// What is known of a camera before any target was seen.
struct CameraPrior {
  std::vector<double> mean;  ///< parameters, as the model has them
  Noise noise;
};

struct CalibrationOptions {
  std::string model = "angular4";
  BoardShape board = BoardShape::kFlat;
  /// Standard deviation of a corner's place on the target [m], kFree only; 0: a fiftieth of the
  /// distance between neighbouring corners.
  double corner_sigma_m = 0;
  /// A corner farther from where it is predicted than this many standard deviations is set aside.
  double outlier_sigmas = 5;
  /// Standard deviation of a detected corner [px] on either axis; 0: from the residuals.
  double sigma_px = 0;
  std::vector<CameraPrior> camera_priors;  ///< one a camera, or none
  SolveOptions solve;
  /// Called before each solve, by several threads where models are compared: what it throws, if no
  /// Error, ends all of it.
  std::function<void()> before_solve;
};

/// The options' corner_sigma_m, or what it is where they leave it to the target.
double CornerSigma(const Detections& detections, const CalibrationOptions& options);

/// Which corners count: one number a corner of every view, 0 for one that was set aside.
using CornerUse = std::vector<std::vector<std::uint8_t>>;

/// The factor graph of a calibration: `camera:c` and `camera_from_rig:c`, `target:exposure`,
/// `warp:0`, and with a free board `corner:id`.
///
/// One reprojection factor a view, or one a corner with a free board.  Views of an exposure without
/// pose are left out.  Variables that nothing is asked of (warp of a flat board, the first camera's
/// place) are fixed.  Throws Error (kUsage): a state that does not fit the detections.
Graph BuildCalibration(const Registry& types, const Detections& detections,
                       const CalibrationState& state, const CornerUse& use,
                       const CalibrationOptions& options, double sigma_px);

/// The state that the graph's values say.
CalibrationState ReadBackCalibration(const Graph& graph, const Values& values,
                                     CalibrationState state);

/// Predicted - measured [px] of every corner of a view; NaN where the model has no image of it, or
/// its exposure has no pose.
std::vector<Eigen::Vector2d> ViewResiduals(const CalibrationState& state, const TargetView& view);

/// A corner that was set aside.
struct Outlier {
  std::size_t view = 0, corner = 0;  ///< into Detections
  double error_px = 0;
};

/// A solved calibration.
struct Calibration {
  CalibrationState state;
  CornerUse use;
  std::vector<Outlier> outliers;      ///< worst first
  std::vector<std::size_t> left_out;  ///< views without a pose, in order
  std::size_t corners = 0;            ///< that count
  int freedoms = 0;                   ///< estimated numbers
  double rms_px = 0, worst_px = 0;    ///< of the distance of a corner from where it is predicted
  double sigma_px = 0;                ///< of either coordinate of a corner, from the residuals:
                                      ///< sqrt(sum / (2 corners - freedoms))
  double weight_sigma_px = 0;         ///< what the last solve took it for
  Report report;                      ///< of the last solve
};

/// Solves from a start, sets corners aside, and solves again until the same corners count.
/// Deterministic.
Calibration RefineCalibration(const Registry& types, const Detections& detections,
                              const CalibrationState& start, const CalibrationOptions& options);

}  // namespace graticule
