#include "graticule/problems/calibration/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/problems/calibration/first_guess.hpp"

namespace graticule {
ReprojectionError SummariseErrors(std::vector<double>* distances) {
  ReprojectionError error;
  const auto first_nan = std::stable_partition(distances->begin(), distances->end(),
                                               [](double d) { return std::isfinite(d); });
  error.unseen = static_cast<std::size_t>(distances->end() - first_nan);
  distances->erase(first_nan, distances->end());
  error.corners = distances->size();
  if (distances->empty()) return error;
  std::sort(distances->begin(), distances->end());
  double sum = 0, squares = 0;
  for (const double d : *distances) {
    sum += d;
    squares += d * d;
  }
  const auto count = static_cast<double>(distances->size());
  const auto at = [&](double part) {
    return (*distances)[static_cast<std::size_t>(part * (count - 1))];
  };
  error.mean_px = sum / count;
  error.rms_px = std::sqrt(squares / count);
  error.median_px = at(0.5);
  error.percentile_995_px = at(0.995);
  error.max_px = distances->back();
  return error;
}

double HeldOutError_px(const ReprojectionError& error) {
  const auto seen = static_cast<double>(error.corners), unseen = static_cast<double>(error.unseen);
  constexpr double kUnseen = 10;  // px
  return (seen * error.mean_px + unseen * kUnseen) / (seen + unseen);
}

ReprojectionError EvaluateOn(const CalibrationState& calibration, const Detections& test,
                             std::vector<std::vector<double>>* distances_px,
                             const std::vector<std::optional<Se3Array>>* starts) {
  constexpr double kHuber = 3;  // px: a corner that is far off must not move the pose
  CalibrationState state = calibration;
  state.rig_from_target.assign(test.exposures, std::nullopt);
  std::vector<Camera> cameras;
  for (const CameraIntrinsics& camera : state.cameras) cameras.emplace_back(camera);
  if (distances_px) distances_px->assign(test.views.size(), {});
  std::vector<double> all;
  std::size_t views = 0;
  for (std::size_t v = 0; v < test.views.size(); ++v) {
    const TargetView& view = test.views[v];
    // Each view by itself: a rig's places are judged by its own covariance, not here.
    const CornerPairs pairs = PairsOf(state, view);
    const Camera& camera = cameras[view.camera];
    std::optional<TargetPose> found;
    if (starts && (*starts)[view.exposure])
      found = RefineTargetPose(
          camera, pairs,
          IsometryOf(state.camera_from_rig[view.camera]) * IsometryOf(*(*starts)[view.exposure]),
          kHuber);
    else
      found = FindTargetPose(camera, pairs, kHuber, 50);
    std::vector<double> distances(view.corners.size(), std::numeric_limits<double>::quiet_NaN());
    if (found) {
      ++views;
      state.rig_from_target[view.exposure] = PoseOf(
          IsometryOf(state.camera_from_rig[view.camera]).inverse() * found->camera_from_target);
      const auto residuals = ViewResiduals(state, view);
      for (std::size_t i = 0; i < residuals.size(); ++i) distances[i] = residuals[i].norm();
    }
    all.insert(all.end(), distances.begin(), distances.end());
    if (distances_px) (*distances_px)[v] = std::move(distances);
  }
  ReprojectionError error = SummariseErrors(&all);
  error.views = views;
  return error;
}

ReprojectionError CrossValidate(const Registry& types, const Detections& detections,
                                const Calibration& calibration, const CalibrationOptions& options,
                                int folds, std::vector<ReprojectionError>* by_exposure) {
  std::vector<double> all;
  std::size_t views = 0;
  std::vector<std::vector<double>> of_exposure(detections.exposures);
  for (int fold = 0; fold < folds; ++fold) {
    Detections train = detections, test = detections;
    train.views.clear();
    test.views.clear();
    CalibrationState start = calibration.state;
    for (const TargetView& view : detections.views) {
      const bool is_test =
          static_cast<int>(view.exposure % static_cast<std::size_t>(folds)) == fold;
      if (is_test) start.rig_from_target[view.exposure].reset();
      (is_test ? test : train).views.push_back(view);
    }
    if (test.views.empty() || train.views.empty()) continue;
    const Calibration trained = RefineCalibration(types, train, start, options);
    std::vector<std::vector<double>> distances;
    views += EvaluateOn(trained.state, test, &distances).views;
    for (std::size_t v = 0; v < distances.size(); ++v) {
      std::vector<double>& here = of_exposure[test.views[v].exposure];
      here.insert(here.end(), distances[v].begin(), distances[v].end());
      all.insert(all.end(), distances[v].begin(), distances[v].end());
    }
  }
  ReprojectionError error = SummariseErrors(&all);
  error.views = views;
  if (by_exposure) {
    by_exposure->clear();
    for (std::vector<double>& here : of_exposure) by_exposure->push_back(SummariseErrors(&here));
  }
  return error;
}

}  // namespace graticule
