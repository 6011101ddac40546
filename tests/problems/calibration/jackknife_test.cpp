#include "graticule/problems/calibration/jackknife.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/calibrate.hpp"
#include "graticule/problems/calibration/simulate.hpp"

namespace graticule {
namespace {

CalibrationSimulation Simulation(std::uint64_t seed) {
  CalibrationSimulation simulation;
  simulation.camera = StudyLenses()[3].camera;
  simulation.camera.model = "angular2";
  simulation.camera.parameters.resize(6);
  simulation.sigma_px = 0.1;
  simulation.seed = seed;
  return simulation;
}

Calibration Solved(const SimulatedDetections& frames) {
  CalibrationOptions options;
  options.model = "angular2";
  return RefineCalibration(Builtins(), frames.detections, frames.truth, options);
}

// Every exposure left out and everything solved again: what the closed form stands for.
TEST(Jackknife, IsWhatLeavingExposuresOutMoves) {
  SimulatedDetections frames = SimulateDetections(Simulation(4), Person::kRosRules, 14);
  // Views disagree: each is shifted as a whole.
  for (std::size_t v = 0; v < frames.detections.views.size(); ++v)
    for (DetectedCorner& corner : frames.detections.views[v].corners) {
      corner.pixel[0] += 0.4 * std::sin(0.02 * corner.pixel[1] + static_cast<double>(v));
      corner.pixel[1] += 0.4 * std::cos(0.02 * corner.pixel[0] + 2.0 * static_cast<double>(v));
    }
  const Calibration whole = Solved(frames);
  PosteriorOptions options;
  options.sigma_px = whole.sigma_px;
  Posterior posterior = ComputePosterior(frames.detections, whole.state, whole.use, options);
  const std::vector<double> before = posterior.Deviations("camera:0");
  const double raised =
      RaiseByJackknife(frames.detections, whole.state, whole.use, options, &posterior);
  EXPECT_GT(raised, 1.2);
  const std::vector<double> after = posterior.Deviations("camera:0");

  std::vector<std::vector<double>> without;
  for (std::size_t e = 0; e < frames.detections.exposures; ++e) {
    if (!whole.state.rig_from_target[e]) continue;
    Detections rest = frames.detections;
    rest.views.erase(rest.views.begin() + static_cast<std::ptrdiff_t>(e));
    CalibrationState start = whole.state;
    start.rig_from_target[e].reset();
    CalibrationOptions again;
    again.model = "angular2";
    again.outlier_sigmas = 1e3;
    without.push_back(
        RefineCalibration(Builtins(), rest, start, again).state.cameras[0].parameters);
  }
  const auto n = static_cast<double>(without.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    double mean = 0, squares = 0;
    for (const auto& parameters : without) mean += parameters[i] / n;
    for (const auto& parameters : without) squares += std::pow(parameters[i] - mean, 2);
    const double spread = std::sqrt(squares * (n - 1) / n);
    // Never below the posterior's own; else as solving says, but for one Newton step's error.
    EXPECT_GE(after[i], 0.999 * before[i]);
    EXPECT_NEAR(after[i], std::max(spread, before[i]), 0.25 * after[i]) << i;
  }
}

TEST(Jackknife, HardlyRaisesWhatHasOnlyIndependentNoise) {
  double sum = 0;
  constexpr int kTrials = 10;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const SimulatedDetections frames = SimulateDetections(Simulation(seed), Person::kRosRules, 30);
    const Calibration whole = Solved(frames);
    PosteriorOptions options;
    options.sigma_px = whole.sigma_px;
    Posterior posterior = ComputePosterior(frames.detections, whole.state, whole.use, options);
    sum += RaiseByJackknife(frames.detections, whole.state, whole.use, options, &posterior);
  }
  EXPECT_LT(sum / kTrials, 1.6);  // what exceeds one by chance is kept, what falls short is not
  EXPECT_GE(sum / kTrials, 1);
}

TEST(Jackknife, LeavesFewExposuresAsTheyAre) {
  const SimulatedDetections frames = SimulateDetections(Simulation(2), Person::kRosRules, 3);
  const Calibration whole = Solved(frames);
  PosteriorOptions options;
  Posterior posterior = ComputePosterior(frames.detections, whole.state, whole.use, options);
  const Eigen::MatrixXd before = posterior.covariance;
  EXPECT_EQ(RaiseByJackknife(frames.detections, whole.state, whole.use, options, &posterior), 1);
  EXPECT_EQ(before, posterior.covariance);
}

}  // namespace
}  // namespace graticule
