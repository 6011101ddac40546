#include "graticule/problems/calibration/study.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/difference.hpp"
#include "graticule/problems/calibration/target_pose.hpp"
#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kNeverPx = 1e3;  // error of a camera that is not known at all

CornerPairs PairsOf(const std::vector<DetectedCorner>& corners) {
  CornerPairs pairs;
  for (const DetectedCorner& corner : corners) {
    pairs.in_target.emplace_back(corner.in_target.data());
    pairs.pixels.emplace_back(corner.pixel[0], corner.pixel[1]);
  }
  return pairs;
}

// A person sees hollow quads on the screen, not a pose: the target goes where its image matches
// them best, by the true camera.
Se3Array Matched(const Suggestion& suggestion, const Camera& truth) {
  constexpr double kAnyDistance = 1e6;  // px: no corner is an outlier
  const auto pose = FindTargetPose(truth, PairsOf(suggestion.corners), kAnyDistance);
  return pose ? PoseOf(pose->camera_from_target) : suggestion.camera_from_target;
}

Se3Array NextPose(const StudyOptions& options, const CalibrationSession& session,
                  const Camera& truth, RandomNumbers& random) {
  if (options.strategy == Strategy::kSuggestions) {
    const auto suggestion = session.Suggest();
    if (suggestion)
      return HeldAt(Matched(*suggestion, truth), truth, options.target, options.hands, random);
  }
  return PoseByPerson(options.strategy == Strategy::kRosRules ? Person::kRosRules : Person::kNovice,
                      session.FrameCount(), truth, options.target, random);
}

// Rays that the second has no image of are as far off as can be.
double LargestDifference(const Camera& first, const Camera& second) {
  DifferenceOptions options;
  options.nodes = 25;
  const CalibrationDifference difference = Difference(first, second, options);
  return difference.unseen > 0 ? kNeverPx : std::min(kNeverPx, difference.max_px);
}

// On a test set whose poses are nearly known; corners without an image are as far off as can be.
ReprojectionError ErrorOn(const SimulatedDetections& test_set, const CameraIntrinsics& model) {
  CalibrationState state = test_set.truth;
  state.cameras = {model};
  std::vector<std::vector<double>> distances;
  EvaluateOn(state, test_set.detections, &distances, &test_set.truth.rig_from_target);
  std::vector<double> all;
  for (const std::vector<double>& view : distances)
    for (const double distance : view)
      all.push_back(std::isfinite(distance) ? std::min(kNeverPx, distance) : kNeverPx);
  return SummariseErrors(&all);
}

StudyFrame Measure(const CalibrationSession& session, const Camera& truth, RandomNumbers* random) {
  StudyFrame frame;
  frame.true_max_px = frame.drawn_max_px = frame.max_ere_px = frame.raw_max_ere_px = kNeverPx;
  frame.test.mean_px = frame.test.percentile_995_px = frame.test.max_px = kNeverPx;
  if (!session.Solved()) return frame;
  frame.is_bootstrapping = session.IsBootstrapping();
  frame.is_met = session.AccuracyMet();
  frame.max_ere_px = session.MaxEre().MaxPx();
  const Camera found(session.Solved()->state.cameras[0]);
  EreOptions raw;
  raw.gauge = EreGauge::kRaw;
  frame.raw_max_ere_px = EreGrid(found, raw).MaxPx(session.Uncertainty()->OfCamera(0));
  frame.true_max_px = LargestDifference(truth, found);
  CameraIntrinsics drawn = found.Intrinsics();
  drawn.parameters = DrawnParameters(found, session.Uncertainty()->OfCamera(0), random);
  if (drawn.parameters[0] > 0 && drawn.parameters[1] > 0)
    frame.drawn_max_px = LargestDifference(found, Camera(drawn));
  return frame;
}

StudyTrial RunTrial(const StudyOptions& options, const Registry& types, const Camera& truth,
                    const SimulatedDetections& test_set, std::size_t number) {
  RandomNumbers random(options.seed, 2 * number), draws(options.seed, 2 * number + 1);
  CalibrationSession session(types, options.target,
                             {options.lens.camera.name, truth.Width(), truth.Height()},
                             options.session);
  StudyTrial trial;
  // Frames that show too little are not kept, and taken again.
  for (std::size_t tries = 0; trial.frames.size() < options.frames && tries < 3 * options.frames;
       ++tries) {
    std::vector<DetectedCorner> corners =
        VisibleCorners(truth, options.target, NextPose(options, session, truth, random),
                       options.warp, options.session.suggest.detectability);
    AddPixelNoise(options.sigma_px, random, &corners);
    if (session.AddFrame(corners) == FrameVerdict::kTooFewCorners) continue;
    trial.frames.push_back(Measure(session, truth, &draws));
    const bool is_last = trial.frames.size() == options.frames;
    if (session.Solved() && (options.test_every_frame || is_last))
      trial.frames.back().test = ErrorOn(test_set, session.Solved()->state.cameras[0]);
  }
  if (session.Solved()) trial.camera = session.Solved()->state.cameras[0];
  return trial;
}

}  // namespace

const char* NameOf(Strategy strategy) {
  switch (strategy) {
    case Strategy::kSuggestions:
      return "suggestions";
    case Strategy::kRosRules:
      return "ros_rules";
    case Strategy::kNovice:
      break;
  }
  return "novice";
}

std::vector<StudyTrial> RunStudy(const StudyOptions& options) {
  if (options.trials < 1 || options.frames < 1)
    throw Error("study: expected trials and frames", ErrorKind::kUsage);
  const Camera truth(options.lens.camera);
  const SimulatedDetections test_set = TestSet(options.lens.camera, options.target);
  std::vector<StudyTrial> trials(static_cast<std::size_t>(options.trials));
  ParallelFor(trials.size(), std::max<std::size_t>(1, options.threads),
              [&](std::size_t, std::size_t i) {
                trials[i] = RunTrial(options, Builtins(), truth, test_set, i);
              });
  return trials;
}

SimulatedDetections TestSet(const CameraIntrinsics& truth, const TargetLayout& target,
                            std::size_t views, std::uint64_t seed) {
  const Camera camera(truth);
  RandomNumbers random(seed);
  std::vector<Se3Array> poses;
  while (poses.size() < views) {
    Placement p;
    p.across = random.Uniform(0.02, 0.98);
    p.down = random.Uniform(0.02, 0.98);
    p.size = random.Uniform(0.3, 0.9);
    p.tilt_sideways = random.Uniform(-0.7, 0.7);
    p.tilt_up = random.Uniform(-0.7, 0.7);
    p.roll = random.Uniform(-0.5, 0.5);
    const auto pose = PlaceTarget(camera, target, p);
    if (pose && VisibleCorners(camera, target, *pose).size() >= 32) poses.push_back(*pose);
  }
  CalibrationSimulation simulation;
  simulation.camera = truth;
  simulation.target = target;
  simulation.sigma_px = 0;
  return SimulateDetections(simulation, poses);
}

std::size_t FramesNeeded(const StudyTrial& trial, double below_px) {
  std::size_t needed = trial.frames.size();
  while (needed > 0 && trial.frames[needed - 1].true_max_px < below_px) --needed;
  return needed == trial.frames.size() ? 0 : needed + 1;
}

double RankCorrelation(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size() || a.size() < 2)
    throw Error("rank correlation: expected two or more pairs", ErrorKind::kUsage);
  const auto ranks = [](const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return values[i] < values[j]; });
    std::vector<double> rank(values.size());
    for (std::size_t i = 0; i < order.size();) {
      std::size_t end = i;
      while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
      for (std::size_t k = i; k < end; ++k) rank[order[k]] = static_cast<double>(i + end - 1) / 2;
      i = end;
    }
    return rank;
  };
  const std::vector<double> x = ranks(a), y = ranks(b);
  const double mean = static_cast<double>(a.size() - 1) / 2;
  double xy = 0, xx = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mean) * (y[i] - mean);
    xx += (x[i] - mean) * (x[i] - mean);
    yy += (y[i] - mean) * (y[i] - mean);
  }
  return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
}

Coverage MeasureCoverage(const Registry& types, const CoverageOptions& options) {
  const Eigen::Map<const Eigen::VectorXd> truth(
      options.lens.camera.parameters.data(),
      static_cast<Eigen::Index>(options.lens.camera.parameters.size()));
  const double limit = ChiSquareQuantile(options.probability, static_cast<double>(truth.size()));
  std::vector<double> squared(static_cast<std::size_t>(options.trials));
  ParallelFor(
      squared.size(), std::max<std::size_t>(1, options.threads), [&](std::size_t, std::size_t i) {
        CalibrationSimulation simulation;
        simulation.camera = options.lens.camera;
        simulation.sigma_px = options.sigma_px;
        simulation.seed = options.seed + 1000003 * i;
        SimulatedDetections simulated =
            SimulateDetections(simulation, Person::kRosRules, options.frames);
        CalibrationState start = simulated.truth;
        for (int k = 0; k < 2; ++k) start.cameras[0].parameters[k] *= 1.01;
        const Calibration solved = RefineCalibration(types, simulated.detections, start, {});
        PosteriorOptions asked;
        asked.sigma_px = solved.sigma_px;
        const Posterior posterior =
            ComputePosterior(simulated.detections, solved.state, solved.use, asked);
        const Eigen::Map<const Eigen::VectorXd> found(solved.state.cameras[0].parameters.data(),
                                                      truth.size());
        const Eigen::VectorXd error = found - truth;
        squared[i] = error.dot(posterior.information * error);
      });
  Coverage coverage;
  coverage.trials = options.trials;
  for (const double value : squared) {
    coverage.inside += value <= limit;
    coverage.mean_squared +=
        value / (static_cast<double>(truth.size()) * static_cast<double>(options.trials));
  }
  return coverage;
}

}  // namespace graticule
