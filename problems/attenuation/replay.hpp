#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/predictor.hpp"

namespace graticule {

/// The intervals whose coverage is counted.
constexpr std::array<double, 4> kCoverageLevels = {0.5, 0.68, 0.9, 0.95};

/// How well predictions came true.
struct SignalScore {
  std::size_t count = 0;
  double mse = 0, rmse = 0;             ///< dB^2, dB: over all predictions alike
  double standard_error = 0;            ///< of mse, from its scatter between steps
  double negative_log_likelihood = 0;   ///< a prediction's, Gaussian
  double crps = 0;                      ///< continuous ranked probability score [dB]
  std::array<double, 4> coverage = {};  ///< share within the central interval of kCoverageLevels
};

/// Continuous ranked probability score of a Gaussian prediction [dB] (Gneiting and Raftery 2007).
double GaussianCrps(const SignalPrediction& prediction, double dbm);

/// 1 - mse / mse of a reference: 1 is perfect, 0 no better.
double Skill(const SignalScore& score, const SignalScore& reference);

struct ReplayOptions {
  double step_s = 2;
  int horizons = 10;                  ///< of step_s each
  std::function<void()> before_step;  ///< what it throws ends the replay; empty: none
  double new_drive_s =
      30;  ///< a pause this long ends a drive: a step before it predicts none after
  /// Learns each drive from nothing, by a fresh predictor.  Else what was learnt is kept.
  bool forget_between_drives = false;
  double leave_s = 0;     ///< predicts nothing for so long after the first measurement
  std::size_t every = 1;  ///< predicts at each so many'th step only (updates at all of them)
};

/// One step's predictions, by horizon: their squared errors' sum [dB^2], and how many they are.
struct StepErrors {
  std::size_t drive = 0;
  std::vector<double> squares;
  std::vector<std::size_t> counts;
};

struct ReplayResult {
  std::string method;
  std::vector<SignalScore> horizons;
  SignalScore all;
  std::vector<StepErrors> steps;         ///< that predicted anything
  double update_ms = 0, predict_ms = 0;  ///< wall clock a step, mean
};

/// The prequential replay of thesis 3.3.1: measurements are given step by step; after each step the
/// method predicts what comes in the following intervals, and then learns from it.  Steps without a
/// measurement are passed over; the first step learns only.  Measurements that were not heard are
/// not predicted.  `make` makes a predictor that knows its map.  Throws Error (kInput): a log
/// without time.
ReplayResult Replay(const SignalLog& log,
                    const std::function<std::unique_ptr<SignalPredictor>()>& make,
                    const ReplayOptions& options = {});

/// Root mean squared error of each horizon [dB], the mean of the drives' own: all drives count
/// alike, however long.
std::vector<double> RmseOverDrives(const ReplayResult& result);

/// By how much the mean squared error of one method is above another's [dB^2], with its standard
/// error.
struct PairedDifference {
  double mse = 0, standard_error = 0;
};

/// Of two methods that were replayed over the same logs, over horizons `from` to before `to` of
/// them all.  The two are wrong together, and a step is as its neighbours are: the standard error
/// is that of sums over blocks of steps (a ratio's, by its linear part).  Throws Error (kUsage):
/// replays that are not of the same steps.
PairedDifference ComparePaired(const std::vector<ReplayResult>& method,
                               const std::vector<ReplayResult>& other, std::size_t from,
                               std::size_t to, std::size_t block_steps = 15);

/// Which measurements are learnt from, and which are then predicted.
struct HoldOut {
  std::vector<std::uint32_t> train, test;
};

/// Links at random (both ways of a link on one side), this part of them to predict.
HoldOut RandomLinks(const SignalLog& log, double part, std::uint64_t seed);
/// This part of all radios is never heard of in training: links of one such radio, or of two.
HoldOut UnseenRadios(const SignalLog& log, double part, std::uint64_t seed, int unseen_ends);
/// A frontier that sweeps the map along x: split i of `count` learns from links whose ends both lie
/// before the frontier, and predicts those with the far end in the next strip and the other before
/// it.  The frontier moves from the radios' quantile 0.3 to 1 in equal parts.
std::vector<HoldOut> FrontierSweep(const SignalLog& log, int count);

/// Learns from one part and predicts the other, for each split alike.
ReplayResult EvaluateHoldOut(const SignalLog& log, const std::vector<HoldOut>& splits,
                             const std::function<std::unique_ptr<SignalPredictor>()>& make);

}  // namespace graticule
