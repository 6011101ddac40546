#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graticule/problems/calibration/bootstrap.hpp"
#include "graticule/problems/calibration/suggest.hpp"

namespace graticule {

struct SessionOptions {
  CalibrationOptions calibration;   ///< model, board, sigma
  SuggestOptions suggest;           ///< its sigma_px is set from the calibration's
  double accuracy_px = 1;           ///< Max ERE that is enough, in the gauge of suggest.ere
  std::size_t fewest_corners = 12;  ///< of a frame that is worth keeping
};

/// What became of a frame.
enum class FrameVerdict {
  kUsed,
  kTooFewCorners,  ///< not kept
  kNotExplained,   ///< kept, but no pose explains it; a later frame may
};

/// A guided calibration without a screen: frames go in, advice comes out.
///
/// Two phases, as in the thesis (section 5.2), without a seam.  Bootstrapping: with one, two and
/// three frames the camera is solved under a prior that widens (FirstPrior: centre near the middle,
/// focal lengths alike, terms small), where the thesis has models with fewer parameters.
/// Uncertainty reduction: as soon as three frames or more constrain every parameter, they speak
/// alone.  Deterministic.
class CalibrationSession {
 public:
  /// Throws Error (kUsage): a target without corners, an image without size, no such model.
  CalibrationSession(Registry types, TargetLayout target, ImageSize image,
                     SessionOptions options = {});

  /// Adds a frame and solves again.  The corners' places are the target's own.
  FrameVerdict AddFrame(const std::vector<DetectedCorner>& corners);

  const Detections& Frames() const { return detections_; }
  std::size_t FrameCount() const { return detections_.views.size(); }
  /// None before a frame was explained.
  const std::optional<Calibration>& Solved() const { return solved_; }
  /// Of the same; with the prior while bootstrapping.
  const std::optional<Posterior>& Uncertainty() const { return posterior_; }
  /// Parameters are held by what was known before, not by the frames.
  bool IsBootstrapping() const { return prior_width_ > 0; }
  /// Standard deviation of a corner's coordinates [px]: as the options say, or from the residuals,
  /// of which few frames have few: Equation 5.6's, 7e-5 of the image's width, counts as 50 of them.
  double SigmaPx() const;
  /// Over the image; empty before anything is known.  While bootstrapping it is what the prior
  /// leaves, and no accuracy.
  EreMap MaxEre() const;
  /// Every parameter is constrained by frames, and Max ERE is small enough.
  bool AccuracyMet() const;
  /// What to show the camera next; none only where the target cannot be seen at all.
  std::optional<Suggestion> Suggest() const;

 private:
  void SolveFromNothing();
  void SolveOn();
  void Settle(const CalibrationState& start);

  Registry types_;
  TargetLayout target_;
  SessionOptions options_;
  Detections detections_;
  double prior_width_ = 1;  ///< 0: none
  std::optional<Calibration> solved_;
  std::optional<Posterior> posterior_;
};

}  // namespace graticule
