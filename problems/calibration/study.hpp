#pragma once

#include <cstdint>
#include <vector>

#include "graticule/problems/calibration/evaluate.hpp"
#include "graticule/problems/calibration/session.hpp"
#include "graticule/problems/calibration/simulate.hpp"

namespace graticule {

/// Who chooses the frames.
enum class Strategy { kSuggestions, kRosRules, kNovice };
const char* NameOf(Strategy strategy);

/// The thesis' human study (section 5.4), simulated: people calibrate a camera whose truth is
/// known.
struct StudyOptions {
  StudyLens lens;
  Strategy strategy = Strategy::kSuggestions;
  SessionOptions session;
  TargetLayout target = LayoutOf(AprilCalMosaic());
  std::array<double, 3> warp = {};  ///< of the target they hold [1/m]
  double sigma_px = 0.2;
  HandNoise hands;
  int trials = 100;
  std::size_t frames = 8;         ///< a trial
  bool test_every_frame = false;  ///< with the test set; else only after the last
  std::size_t threads = 2;
  std::uint64_t seed = 1;
};

/// After a frame of a trial.
struct StudyFrame {
  bool is_bootstrapping = true;
  bool is_met = false;    ///< the session's AccuracyMet
  double max_ere_px = 0;  ///< as the session says, the frame's rotation taken out
  double raw_max_ere_px = 0;
  /// Largest difference to the truth over a grid of 25 x 19 pixels, the rotation taken out.
  double true_max_px = 0;
  /// The same difference to a camera that is drawn from the session's posterior: what true_max_px
  /// is like where the posterior is right.
  double drawn_max_px = 0;
  /// On a test set of views all over the image, without noise (EvaluateOn, begun at the true
  /// poses), where it was asked for.
  ReprojectionError test;
};

struct StudyTrial {
  std::vector<StudyFrame> frames;
  CameraIntrinsics camera;  ///< in the end
};

/// Trials in parallel; each depends on the seed and its number alone.
std::vector<StudyTrial> RunStudy(const StudyOptions& options);

/// The test set of a camera: target poses all over the image, near and far, tilted.
SimulatedDetections TestSet(const CameraIntrinsics& truth, const TargetLayout& target,
                            std::size_t views = 60, std::uint64_t seed = 7);

/// The first count of frames from which on the true error stays below `below_px`; 0 if it never
/// does.
std::size_t FramesNeeded(const StudyTrial& trial, double below_px);

/// Spearman's: correlation of ranks, ties sharing theirs.
double RankCorrelation(const std::vector<double>& a, const std::vector<double>& b);

/// How often the truth lies in the region that the posterior says holds it with this probability.
/// Frames by the ROS rules, solved from a start that is off.
struct CoverageOptions {
  StudyLens lens;
  double sigma_px = 0.2;
  std::size_t frames = 8;
  int trials = 500;
  double probability = 0.95;
  std::size_t threads = 2;
  std::uint64_t seed = 1;
};
struct Coverage {
  int trials = 0, inside = 0;
  double mean_squared = 0;  ///< of the Mahalanobis distance, over the number of parameters: 1
};
Coverage MeasureCoverage(const Registry& types, const CoverageOptions& options);

}  // namespace graticule
