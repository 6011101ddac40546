#include "graticule/problems/calibration/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "graticule/problems/calibration/first_guess.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Views of one camera, everything else as it was.
Detections OnlyCamera(const Detections& detections, std::size_t camera) {
  Detections only;
  only.cameras = {detections.cameras[camera]};
  only.exposures = detections.exposures;
  for (const TargetView& view : detections.views) {
    if (view.camera != camera) continue;
    only.views.push_back(view);
    only.views.back().camera = 0;
  }
  return only;
}

// One camera from nothing, as angular4, with all the views that it explains.
CalibrationState SolveCamera(const Registry& types, const Detections& detections,
                             const CalibrationOptions& options) {
  const std::vector<FirstGuess> guesses = GuessCamera(types, detections, 0);
  const std::string& name = detections.cameras[0].camera;
  if (guesses.empty())
    throw Error("camera " + name + ": no view of it has six corners or more; nothing can be said",
                ErrorKind::kIllPosed);
  CalibrationState state;
  state.cameras = {guesses.front().camera};
  state.camera_from_rig = {kIdentityPose};
  state.rig_from_target.resize(detections.exposures);
  CalibrationOptions first = options;
  first.model = guesses.front().camera.model;
  first.board = BoardShape::kFlat;
  // Views that the guess did not look at may lie where it knows nothing yet: generous first, and
  // again as long as more of them are explained.
  std::size_t placed = 0;
  for (int round = 0; round < 6; ++round) {
    const double factor = round == 0 ? 30 : 10;
    PlaceTargets(detections, std::max(3.0, factor * guesses.front().median_px), &state);
    first.camera_priors = {FirstPrior(state.cameras[0], 25)};
    state = RefineCalibration(types, detections, state, first).state;
    const auto count = static_cast<std::size_t>(
        std::count_if(state.rig_from_target.begin(), state.rig_from_target.end(),
                      [](const auto& pose) { return pose.has_value(); }));
    if (round > 0 && count <= placed) break;
    placed = count;
  }
  if (placed == 0)
    throw Error("camera " + name + ": no view of it is explained by any camera; do the corners' " +
                    "places on the target, and their order, belong to it?",
                ErrorKind::kIllPosed);
  return state;
}

double Apart(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d between = a.inverse() * b;
  return Eigen::AngleAxisd(between.linear()).angle() +
         between.translation().norm() / (1e-9 + a.translation().norm() + b.translation().norm());
}

// Where camera b is, seen from camera a: the one of their shared exposures' answers that is nearest
// to the others.
std::optional<Eigen::Isometry3d> Between(const CalibrationState& a, const CalibrationState& b,
                                         std::size_t* shared) {
  std::vector<Eigen::Isometry3d> answers;
  for (std::size_t e = 0; e < a.rig_from_target.size(); ++e)
    if (a.rig_from_target[e] && b.rig_from_target[e])
      answers.push_back(IsometryOf(*a.rig_from_target[e]) *
                        IsometryOf(*b.rig_from_target[e]).inverse());
  *shared = answers.size();
  std::optional<Eigen::Isometry3d> best;
  double least = HUGE_VAL;
  for (const Eigen::Isometry3d& answer : answers) {
    double sum = 0;
    for (const Eigen::Isometry3d& other : answers) sum += Apart(answer, other);
    if (sum < least) {
      least = sum;
      best = answer;
    }
  }
  return best;
}

// The cameras' states in one frame, the first camera's: each joins by the pair that shares most.
CalibrationState Assemble(const Detections& detections, const std::vector<CalibrationState>& one) {
  CalibrationState rig;
  rig.rig_from_target.resize(detections.exposures);
  rig.camera_from_rig.assign(one.size(), kIdentityPose);
  for (const CalibrationState& state : one) rig.cameras.push_back(state.cameras[0]);
  std::vector<char> is_in(one.size(), 0);
  for (std::size_t joined = 0; joined < one.size(); ++joined) {
    std::size_t next = 0, most = 0;
    Eigen::Isometry3d camera_from_rig = Eigen::Isometry3d::Identity();
    for (std::size_t a = 0; joined > 0 && a < one.size(); ++a) {
      if (!is_in[a]) continue;
      for (std::size_t b = 0; b < one.size(); ++b) {
        std::size_t shared = 0;
        if (is_in[b]) continue;
        const auto a_from_b = Between(one[a], one[b], &shared);
        if (!a_from_b || shared <= most) continue;
        most = shared;
        next = b;
        camera_from_rig = a_from_b->inverse() * IsometryOf(rig.camera_from_rig[a]);
      }
    }
    if (joined > 0 && most == 0) {
      const auto out = std::find(is_in.begin(), is_in.end(), 0) - is_in.begin();
      throw Error("camera " + rig.cameras[static_cast<std::size_t>(out)].name +
                      " never saw the target together with the others: their places relative to "
                      "one another are not known",
                  ErrorKind::kIllPosed);
    }
    is_in[next] = 1;
    rig.camera_from_rig[next] = PoseOf(camera_from_rig);
    for (std::size_t e = 0; e < detections.exposures; ++e)
      if (!rig.rig_from_target[e] && one[next].rig_from_target[e])
        rig.rig_from_target[e] =
            PoseOf(camera_from_rig.inverse() * IsometryOf(*one[next].rig_from_target[e]));
  }
  return rig;
}

}  // namespace

void PlaceTargets(const Detections& detections, double farthest_px, CalibrationState* state) {
  std::vector<Camera> cameras;
  for (const CameraIntrinsics& camera : state->cameras) cameras.emplace_back(camera);
  std::vector<double> error(detections.exposures, HUGE_VAL);
  const auto rms = [&](const TargetView& view) {
    double sum = 0;
    std::size_t count = 0;
    for (const Eigen::Vector2d& r : ViewResiduals(*state, view)) {
      if (!std::isfinite(r.x())) continue;
      sum += r.squaredNorm();
      ++count;
    }
    return count < 4 ? HUGE_VAL : std::sqrt(sum / static_cast<double>(count));
  };
  for (const TargetView& view : detections.views)
    if (state->rig_from_target[view.exposure])
      error[view.exposure] =
          error[view.exposure] == HUGE_VAL ? rms(view) : std::max(error[view.exposure], rms(view));
  std::vector<double> best(detections.exposures, farthest_px);
  for (const TargetView& view : detections.views) {
    if (error[view.exposure] <= farthest_px) continue;
    const auto found = FindTargetPose(cameras[view.camera], PairsOf(*state, view), farthest_px / 3);
    if (!found || !(found->rms_px < best[view.exposure])) continue;
    best[view.exposure] = found->rms_px;
    const Eigen::Isometry3d rig_from_camera =
        IsometryOf(state->camera_from_rig[view.camera]).inverse();
    state->rig_from_target[view.exposure] = PoseOf(rig_from_camera * found->camera_from_target);
  }
  for (std::size_t e = 0; e < detections.exposures; ++e)
    if (error[e] > farthest_px && best[e] >= farthest_px) state->rig_from_target[e].reset();
}

FittedModel FitModelTo(const Registry& types, const Detections& detections,
                       const CalibrationState& state, std::size_t camera,
                       const std::string& model) {
  std::vector<Eigen::Vector2d> pixels;
  for (const TargetView& view : detections.views)
    if (view.camera == camera && state.rig_from_target[view.exposure])
      for (const DetectedCorner& corner : view.corners)
        pixels.emplace_back(corner.pixel[0], corner.pixel[1]);
  return FitModel(types, Camera(state.cameras[camera]), pixels, model);
}

Calibration ChangeModel(const Registry& types, const Detections& detections,
                        const CalibrationState& state, const CalibrationOptions& options) {
  CalibrationState start = state;
  for (std::size_t c = 0; c < start.cameras.size(); ++c)
    if (start.cameras[c].model != options.model)
      start.cameras[c] = FitModelTo(types, detections, state, c, options.model).camera;
  return RefineCalibration(types, detections, start, options);
}

Calibration BootstrapCalibration(const Registry& types, const Detections& detections,
                                 const CalibrationOptions& options) {
  CalibrationOptions first = options;
  first.camera_priors.clear();
  std::vector<CalibrationState> one;
  for (std::size_t c = 0; c < detections.cameras.size(); ++c)
    one.push_back(SolveCamera(types, OnlyCamera(detections, c), first));
  const CalibrationState rig = Assemble(detections, one);
  return ChangeModel(types, detections, rig, options);
}

}  // namespace graticule
