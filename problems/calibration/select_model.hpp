#pragma once

#include <string>
#include <vector>

#include "graticule/problems/calibration/evaluate.hpp"

namespace graticule {

/// One model on the data, and how well it predicts exposures that it has not seen.
struct ModelTrial {
  std::string model;
  BoardShape board = BoardShape::kFlat;
  int parameters = 0;            ///< of each camera
  bool converged = false;        ///< of the solve with all exposures
  double rms_px = 0;             ///< on what it was made from
  ReprojectionError held_out;    ///< cross-validated
  double difference_px = 0;      ///< mean over exposures of its held-out error less the best one's
  double standard_error_px = 0;  ///< of that mean
  /// Bayesian information criterion on the corners that count for every model (Schwarz 1978), less
  /// the best one's: n log(sum of squares / n) + numbers log(n).
  double bic = 0;
  std::string failure;  ///< why there is no error, or ""
};

struct ModelSelection {
  std::vector<ModelTrial> shapes;  ///< of the target, as they were tried
  std::vector<ModelTrial> trials;  ///< of models, least held-out error first
  std::size_t chosen = 0;          ///< into trials
  Calibration calibration;         ///< of the chosen one, with all detections
  CalibrationOptions options;      ///< that it was made with
};

/// Shapes of the target and then models, all on the same data, judged by five-fold
/// cross-validation over exposures.
///
/// Chosen is, of the models whose held-out error is within two standard errors of the best, at
/// least 1 % and at most 5 % of its error (after Breiman et al. 1984), the one with the most
/// evidence. With more than 40 exposures, 40 of them judge.  `models` empty: all built-in ones.
/// `boards` are tried with the bootstrap's model, in the order given; a shape must be better by a
/// standard error than the one before it.  With fewer than three exposures nothing can be left out:
/// angular1 under a prior, and no error is known.  Throws Error as BootstrapCalibration does.
ModelSelection SelectModel(const Registry& types, const Detections& detections,
                           const CalibrationOptions& options,
                           const std::vector<std::string>& models,
                           const std::vector<BoardShape>& boards);

/// "flat", "warped", "free".
const char* BoardShapeName(BoardShape board);

}  // namespace graticule
