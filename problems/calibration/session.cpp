#include "graticule/problems/calibration/session.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "graticule/problems/calibration/first_guess.hpp"
#include "graticule/problems/calibration/fit_model.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Frames from which the model that was asked for is solved, and a prior is no longer needed if
// they constrain it; more would only delay the accuracy that is waited for.
constexpr std::size_t kBootstrapFrames = 3;
constexpr const char* kFirstModel = "angular4";

double PriorWidth(std::size_t frames) { return frames <= 1 ? 1 : frames == 2 ? 5 : 25; }

std::size_t Explained(const CalibrationState& state) {
  return static_cast<std::size_t>(std::count_if(state.rig_from_target.begin(),
                                                state.rig_from_target.end(),
                                                [](const auto& pose) { return pose.has_value(); }));
}

// The distance from a corner to its nearest, in the middle of all.
double Spacing(const std::vector<TargetCorner>& corners) {
  std::vector<double> nearest;
  for (const TargetCorner& a : corners) {
    double least = HUGE_VAL;
    for (const TargetCorner& b : corners)
      if (a.id != b.id)
        least = std::min(
            least, std::hypot(a.in_target[0] - b.in_target[0], a.in_target[1] - b.in_target[1]));
    nearest.push_back(least);
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

// The camera of another model that looks like this one where corners were seen.
CameraIntrinsics AsModel(const Registry& types, const Detections& detections,
                         const CameraIntrinsics& camera, const std::string& model) {
  if (camera.model == model) return camera;
  std::vector<Eigen::Vector2d> pixels;
  for (const TargetView& view : detections.views)
    for (const DetectedCorner& corner : view.corners)
      pixels.emplace_back(corner.pixel[0], corner.pixel[1]);
  return FitModel(types, Camera(camera), pixels, model).camera;
}

}  // namespace

CalibrationSession::CalibrationSession(Registry types, TargetLayout target, ImageSize image,
                                       SessionOptions options)
    : types_(std::move(types)), target_(std::move(target)), options_(std::move(options)) {
  if (target_.corners.empty() || target_.corners_per_tag == 0)
    throw Error("session: expected a target with corners", ErrorKind::kUsage);
  if (image.width <= 0 || image.height <= 0)
    throw Error("session: expected the size of the images", ErrorKind::kUsage);
  CameraModelOf(options_.calibration.model);
  // As the calibration would have it, but the same for every frame.
  if (!(options_.calibration.corner_sigma_m > 0))
    options_.calibration.corner_sigma_m = Spacing(target_.corners) / 50;
  detections_.cameras = {std::move(image)};
}

FrameVerdict CalibrationSession::AddFrame(const std::vector<DetectedCorner>& corners) {
  std::map<int, std::array<double, 3>> places;
  for (const TargetCorner& corner : target_.corners) places[corner.id] = corner.in_target;
  TargetView view{"frame " + std::to_string(detections_.exposures), 0, detections_.exposures, {}};
  for (DetectedCorner corner : corners) {
    const auto place = places.find(corner.id);
    if (place == places.end()) continue;
    corner.in_target = place->second;
    view.corners.push_back(corner);
  }
  if (view.corners.size() < options_.fewest_corners) return FrameVerdict::kTooFewCorners;
  detections_.views.push_back(std::move(view));
  ++detections_.exposures;

  if (!solved_) {
    SolveFromNothing();
  } else {
    SolveOn();
  }
  return solved_ && solved_->state.rig_from_target.back() ? FrameVerdict::kUsed
                                                          : FrameVerdict::kNotExplained;
}

void CalibrationSession::SolveFromNothing() {
  const std::vector<FirstGuess> guesses = GuessCamera(types_, detections_, 0);
  if (guesses.empty()) return;
  CalibrationState state;
  state.cameras = {guesses.front().camera};
  state.camera_from_rig = {kIdentityPose};
  state.rig_from_target.resize(detections_.exposures);
  PlaceTargets(detections_, std::max(3.0, 10 * guesses.front().median_px), &state);
  if (Explained(state) == 0) return;
  prior_width_ = PriorWidth(Explained(state));
  Settle(state);
}

void CalibrationSession::SolveOn() {
  // Where frames have not reached, the model may be far off, and still be the right start.
  const double reach_px = 0.05 * detections_.cameras[0].width;
  const double before_px = SigmaPx();
  CalibrationState state = solved_->state;
  state.rig_from_target.resize(detections_.exposures);
  PlaceTargets(detections_, reach_px, &state);
  if (prior_width_ > 0) prior_width_ = PriorWidth(Explained(state));
  Settle(state);
  // A first frame can be explained by more than one camera: where the next does not fit, begin
  // anew with both.
  if (detections_.exposures > 2 * kBootstrapFrames ||
      (solved_->left_out.empty() && solved_->sigma_px < 3 * before_px))
    return;
  const Calibration one_way = *solved_;
  const Posterior its_posterior = *posterior_;
  const double its_width = prior_width_;
  SolveFromNothing();
  const std::size_t before = Explained(one_way.state), now = Explained(solved_->state);
  if (now > before || (now == before && solved_->rms_px < one_way.rms_px)) return;
  solved_ = one_way;
  posterior_ = its_posterior;
  prior_width_ = its_width;
}

void CalibrationSession::Settle(const CalibrationState& start) {
  CalibrationState state = start;
  CalibrationOptions options = options_.calibration;
  const bool is_first = Explained(state) < kBootstrapFrames;
  // One or two frames say little of a board's shape.
  if (is_first) {
    options.model = kFirstModel;
    options.board = BoardShape::kFlat;
  }
  state.cameras[0] = AsModel(types_, detections_, state.cameras[0], options.model);
  options.camera_priors.clear();
  if (prior_width_ > 0) options.camera_priors = {FirstPrior(state.cameras[0], prior_width_)};
  const auto solve = [&](const CalibrationState& from) {
    solved_ = RefineCalibration(types_, detections_, from, options);
    PosteriorOptions asked;
    asked.sigma_px = SigmaPx();
    asked.board = options.board;
    asked.corner_sigma_m = options.corner_sigma_m;
    asked.camera_priors = options.camera_priors;
    asked.loose = options_.suggest.loose;
    posterior_ = ComputePosterior(detections_, solved_->state, solved_->use, asked);
    asked.camera_priors.clear();
    return asked;
  };
  const PosteriorOptions without_prior = solve(state);
  if (prior_width_ == 0 || is_first) return;
  if (!ComputePosterior(detections_, solved_->state, solved_->use, without_prior).Constrained())
    return;
  prior_width_ = 0;
  options.camera_priors.clear();
  solve(CalibrationState(solved_->state));
}

double CalibrationSession::SigmaPx() const {
  if (options_.calibration.sigma_px > 0) return options_.calibration.sigma_px;
  const double expected = 7e-5 * detections_.cameras[0].width;
  constexpr double kWeight = 50;
  if (!solved_) return expected;
  const double count = std::max(0., 2. * static_cast<double>(solved_->corners) - solved_->freedoms);
  return std::sqrt((kWeight * expected * expected + count * solved_->sigma_px * solved_->sigma_px) /
                   (kWeight + count));
}

EreMap CalibrationSession::MaxEre() const {
  if (!posterior_) return {};
  EreMap map =
      EreGrid(Camera(solved_->state.cameras[0]), options_.suggest.ere).Map(posterior_->OfCamera(0));
  MarkReached(detections_, 0, solved_->use, &map);
  return map;
}

bool CalibrationSession::AccuracyMet() const {
  return posterior_ && !IsBootstrapping() && posterior_->Constrained() &&
         MaxEre().MaxPx() <= options_.accuracy_px;
}

std::optional<Suggestion> CalibrationSession::Suggest() const {
  SuggestOptions options = options_.suggest;
  options.sigma_px = SigmaPx();
  const Camera camera(solved_ ? solved_->state.cameras[0] : GuessedCamera(detections_.cameras[0]));
  const std::size_t used = solved_ ? Explained(solved_->state) : 0;
  if (used < 2) return SuggestFirstPose(camera, target_, used, options);
  return SuggestPose(
      camera, target_, InformationOfCamera(*posterior_, 0),
      posterior_->scales.segment(posterior_->Block("camera:0").offset, camera.Model().parameters),
      options);
}

}  // namespace graticule
