#include "graticule/problems/calibration/select_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <thread>

#include "graticule/factors/camera_model.hpp"
#include "graticule/problems/calibration/bootstrap.hpp"
#include "graticule/problems/calibration/first_guess.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr int kFolds = 5;
constexpr std::size_t kJudges = 40;  // exposures
constexpr std::size_t kFewest = 3;   // exposures that can judge

// Exposures evenly through the detections, numbered anew.
Detections Some(const Detections& detections) {
  if (detections.exposures <= kJudges) return detections;
  std::vector<std::size_t> number(detections.exposures, kJudges);
  for (std::size_t i = 0; i < kJudges; ++i) number[i * detections.exposures / kJudges] = i;
  Detections some;
  some.cameras = detections.cameras;
  some.exposures = kJudges;
  for (const TargetView& view : detections.views) {
    if (number[view.exposure] == kJudges) continue;
    some.views.push_back(view);
    some.views.back().exposure = number[view.exposure];
  }
  return some;
}

struct Candidate {
  ModelTrial trial;
  Calibration calibration;
  std::vector<ReprojectionError> by_exposure;  // held out
};

// Why a model cannot be the one, without solving for it: it does not bend rays as the views ask,
// by far more than their noise.
std::string Unfit(const Registry& types, const Detections& detections,
                  const CalibrationState& state, const std::string& model) {
  constexpr double kFarOff = 1;  // px
  for (std::size_t c = 0; c < state.cameras.size(); ++c) {
    const FittedModel fitted = FitModelTo(types, detections, state, c, model);
    if (fitted.unseen > 0) return "does not see as wide as the views";
    if (fitted.rms_px > kFarOff)
      return "bends rays otherwise: " + Shown(fitted.rms_px) + " px off at best";
  }
  return "";
}

// With `is_asked_for` it is solved for even where it is known not to fit.
Candidate Try(const Registry& types, const Detections& detections, const CalibrationState& start,
              const CalibrationOptions& options, bool is_asked_for = false) {
  Candidate candidate;
  candidate.trial.model = options.model;
  candidate.trial.board = options.board;
  candidate.trial.parameters = CameraModelOf(options.model).parameters;
  try {
    if (!is_asked_for) candidate.trial.failure = Unfit(types, detections, start, options.model);
    if (!candidate.trial.failure.empty()) return candidate;
    candidate.calibration = ChangeModel(types, detections, start, options);
    candidate.trial.converged = candidate.calibration.report.termination == Termination::kConverged;
    candidate.trial.rms_px = candidate.calibration.rms_px;
    candidate.trial.held_out = CrossValidate(types, detections, candidate.calibration, options,
                                             kFolds, &candidate.by_exposure);
    if (candidate.trial.held_out.corners == 0) candidate.trial.failure = "no view could be placed";
  } catch (const Error& error) {
    candidate.trial.failure = error.what();
  }
  return candidate;
}

double Score(const ModelTrial& trial) {
  return trial.failure.empty() ? HeldOutError_px(trial.held_out) : HUGE_VAL;
}

// Mean and standard error of a's error less b's, over the exposures that have corners.
void Compare(const Candidate& best, Candidate* candidate) {
  std::vector<double> differences;
  for (std::size_t e = 0; e < candidate->by_exposure.size(); ++e) {
    const double d =
        HeldOutError_px(candidate->by_exposure[e]) - HeldOutError_px(best.by_exposure[e]);
    if (std::isfinite(d)) differences.push_back(d);
  }
  const auto n = static_cast<double>(differences.size());
  if (n < 2) return;
  const double mean = std::accumulate(differences.begin(), differences.end(), 0.0) / n;
  double squares = 0;
  for (const double d : differences) squares += (d - mean) * (d - mean);
  candidate->trial.difference_px = mean;
  candidate->trial.standard_error_px = std::sqrt(squares / (n - 1) / n);
}

void ScoreEvidence(const Detections& detections, std::vector<Candidate>* candidates) {
  CornerUse common;
  for (const Candidate& candidate : *candidates) {
    if (!candidate.trial.failure.empty()) continue;
    if (common.empty()) {
      common = candidate.calibration.use;
      continue;
    }
    for (std::size_t v = 0; v < common.size(); ++v)
      for (std::size_t i = 0; i < common[v].size(); ++i)
        common[v][i] = common[v][i] && candidate.calibration.use[v][i];
  }
  double best = HUGE_VAL;
  for (Candidate& candidate : *candidates) {
    candidate.trial.bic = HUGE_VAL;
    if (!candidate.trial.failure.empty()) continue;
    double sum = 0, count = 0;
    for (std::size_t v = 0; v < common.size(); ++v) {
      const auto residuals = ViewResiduals(candidate.calibration.state, detections.views[v]);
      for (std::size_t i = 0; i < residuals.size(); ++i) {
        if (!common[v][i]) continue;
        sum += residuals[i].squaredNorm();
        count += 2;
      }
    }
    if (count == 0) continue;
    candidate.trial.bic =
        count * std::log(sum / count) + candidate.calibration.freedoms * std::log(count);
    best = std::min(best, candidate.trial.bic);
  }
  for (Candidate& candidate : *candidates) candidate.trial.bic -= best;
}

// Too few to leave one out: the restricted model of the thesis (section 5.2), held by a prior.
ModelSelection OfFewViews(const Registry& types, const Detections& detections,
                          const Calibration& start, const CalibrationOptions& options,
                          const std::vector<std::string>& models,
                          const std::vector<BoardShape>& boards) {
  ModelSelection selection;
  selection.options = options;
  selection.options.model = models.size() == 1 ? models.front() : "angular1";
  selection.options.board = boards.size() == 1 ? boards.front() : BoardShape::kFlat;
  CalibrationOptions held = selection.options;
  if (selection.options.model == "angular1")
    for (const CameraIntrinsics& camera : start.state.cameras) {
      CameraIntrinsics restricted = camera;
      restricted.model = "angular1";
      restricted.parameters.resize(5);
      held.camera_priors.push_back(FirstPrior(restricted, 5));
    }
  selection.calibration = ChangeModel(types, detections, start.state, held);
  ModelTrial trial;
  trial.model = selection.options.model;
  trial.board = selection.options.board;
  trial.parameters = CameraModelOf(trial.model).parameters;
  trial.converged = selection.calibration.report.termination == Termination::kConverged;
  trial.rms_px = selection.calibration.rms_px;
  trial.failure = "too few views to leave one out";
  selection.trials = {trial};
  return selection;
}

}  // namespace

const char* BoardShapeName(BoardShape board) {
  return board == BoardShape::kFlat ? "flat" : board == BoardShape::kWarped ? "warped" : "free";
}

ModelSelection SelectModel(const Registry& types, const Detections& detections,
                           const CalibrationOptions& options,
                           const std::vector<std::string>& models,
                           const std::vector<BoardShape>& boards) {
  std::vector<std::string> names = models;
  if (names.empty())
    for (const CameraModel& model : CameraModels()) names.emplace_back(model.name);
  const Detections judges = Some(detections);

  CalibrationOptions first = options;
  first.model = "angular4";
  first.board = BoardShape::kFlat;
  const Calibration start = BootstrapCalibration(types, detections, first);
  CalibrationState judged = start.state;
  if (judges.exposures != detections.exposures) {
    judged.rig_from_target.clear();
    for (std::size_t i = 0; i < kJudges; ++i)
      judged.rig_from_target.push_back(
          start.state.rig_from_target[i * detections.exposures / kJudges]);
  }

  ModelSelection selection;
  selection.options = options;
  const auto placed = static_cast<std::size_t>(
      std::count_if(start.state.rig_from_target.begin(), start.state.rig_from_target.end(),
                    [](const auto& pose) { return pose.has_value(); }));
  if (placed < kFewest) {
    selection = OfFewViews(types, detections, start, options, models, boards);
    return selection;
  }
  // With two models that differ in kind: a target's shape must not make up for what one of them
  // lacks.
  std::vector<Candidate> shapes;
  for (const BoardShape board : boards) {
    std::optional<Candidate> best;
    for (const char* model : {"angular4", "brown5"}) {
      first.board = board;
      first.model = model;
      Candidate candidate = Try(types, judges, judged, first);
      if (!best || Score(candidate.trial) < Score(best->trial)) best = std::move(candidate);
    }
    shapes.push_back(std::move(*best));
  }
  if (shapes.empty()) throw Error("no shape of the target to try", ErrorKind::kUsage);
  std::size_t best_shape = 0;
  while (best_shape < shapes.size() && !shapes[best_shape].trial.failure.empty()) ++best_shape;
  if (best_shape == shapes.size())
    throw Error("no camera explains these views: " + shapes.front().trial.failure +
                    "; do the corners' places on the target, and their order, belong to it?",
                ErrorKind::kIllPosed);
  for (std::size_t i = best_shape + 1; i < shapes.size(); ++i) {
    ModelTrial& against = shapes[i].trial;
    Compare(shapes[best_shape], &shapes[i]);
    const double news = std::max(against.standard_error_px, 0.02 * Score(shapes[best_shape].trial));
    if (against.failure.empty() && against.difference_px < -news) best_shape = i;
  }
  for (const Candidate& shape : shapes) selection.shapes.push_back(shape.trial);
  selection.options.board = boards[best_shape];
  judged = shapes[best_shape].calibration.state;

  const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
  std::vector<Candidate> candidates(names.size());
  ParallelFor(names.size(), threads, [&](std::size_t, std::size_t i) {
    CalibrationOptions one = selection.options;
    one.model = names[i];
    candidates[i] = Try(types, judges, judged, one, names.size() == 1);
  });
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return Score(a.trial) < Score(b.trial); });
  if (candidates.empty() || !candidates.front().trial.failure.empty())
    throw Error("no camera model explains these views" +
                    (candidates.empty() ? "" : ": " + candidates.front().trial.failure),
                ErrorKind::kIllPosed);
  ScoreEvidence(judges, &candidates);
  for (Candidate& candidate : candidates) {
    Compare(candidates.front(), &candidate);
    selection.trials.push_back(candidate.trial);
  }
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    const ModelTrial& trial = selection.trials[i];
    if (!trial.failure.empty() || !trial.converged) continue;
    // Two standard errors, no less than a hundredth (folds are few) and no more than a twentieth
    // (an error that varies wildly is no excuse).
    const double best = Score(selection.trials.front());
    const double slack = std::clamp(2 * trial.standard_error_px, 0.01 * best, 0.05 * best);
    if (trial.difference_px > slack) continue;
    const ModelTrial& chosen = selection.trials[selection.chosen];
    if (trial.bic < chosen.bic || !chosen.converged) selection.chosen = i;
  }
  selection.options.model = selection.trials[selection.chosen].model;
  CalibrationState whole = start.state;
  selection.calibration = ChangeModel(types, detections, whole, selection.options);
  return selection;
}

}  // namespace graticule
