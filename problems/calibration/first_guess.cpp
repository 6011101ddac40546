#include "graticule/problems/calibration/first_guess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace graticule {
namespace {

constexpr std::size_t kViews = 10;    // that first guesses look at
constexpr std::size_t kCorners = 60;  // of each
constexpr const char* kFirstModel = "angular4";

// r = theta + k1 theta^3 + ... of common lenses, as series.
struct Shape {
  const char* name;
  std::array<double, 4> terms;
};
constexpr Shape kShapes[] = {
    {"straight", {1. / 3, 2. / 15, 17. / 315, 62. / 2835}},              // tan(theta)
    {"stereographic", {1. / 12, 1. / 120, 17. / 20160, 31. / 362880}},   // 2 tan(theta/2)
    {"equidistant", {0, 0, 0, 0}},                                       // theta
    {"equisolid", {-1. / 24, 1. / 1920, -1. / 322560, 1. / 92897280}}};  // 2 sin(theta/2)

struct Footprint {
  std::size_t view = 0;
  double x = 0, y = 0, size = 0;  // px
};

double Distance(const Footprint& a, const Footprint& b) {
  return std::hypot(a.x - b.x, a.y - b.y) + std::abs(a.size - b.size);
}

// Views that differ: the largest first, then always the one farthest from those before.
std::vector<std::size_t> DifferentViews(const Detections& detections, std::size_t camera) {
  std::vector<Footprint> left;
  for (std::size_t v = 0; v < detections.views.size(); ++v) {
    const TargetView& view = detections.views[v];
    if (view.camera != camera || view.corners.size() < 6) continue;
    Footprint print{v};
    double low_x = HUGE_VAL, high_x = -HUGE_VAL, low_y = HUGE_VAL, high_y = -HUGE_VAL;
    for (const DetectedCorner& corner : view.corners) {
      low_x = std::min(low_x, corner.pixel[0]);
      high_x = std::max(high_x, corner.pixel[0]);
      low_y = std::min(low_y, corner.pixel[1]);
      high_y = std::max(high_y, corner.pixel[1]);
    }
    print.x = (low_x + high_x) / 2;
    print.y = (low_y + high_y) / 2;
    print.size = std::hypot(high_x - low_x, high_y - low_y);
    left.push_back(print);
  }
  std::vector<std::size_t> chosen;
  std::vector<Footprint> prints;
  while (!left.empty() && chosen.size() < kViews) {
    const auto worth = [&](const Footprint& print) {
      double least = prints.empty() ? print.size : HUGE_VAL;
      for (const Footprint& other : prints) least = std::min(least, Distance(print, other));
      return least;
    };
    // Ties by place, not by number: the order of the views must not matter.
    const auto best = std::max_element(left.begin(), left.end(), [&](const auto& a, const auto& b) {
      const double wa = worth(a), wb = worth(b);
      if (wa != wb) return wa < wb;
      return a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    chosen.push_back(best->view);
    prints.push_back(*best);
    left.erase(best);
  }
  return chosen;
}

// A part of the detections: some corners of some views of one camera, an exposure each.
Detections Sample(const Detections& detections, std::size_t camera,
                  const std::vector<std::size_t>& views) {
  Detections sample;
  sample.cameras = {detections.cameras[camera]};
  for (const std::size_t v : views) {
    TargetView view = detections.views[v];
    view.camera = 0;
    view.exposure = sample.exposures++;
    std::stable_sort(view.corners.begin(), view.corners.end(),
                     [](const auto& a, const auto& b) { return a.id < b.id; });
    if (view.corners.size() > kCorners) {
      std::vector<DetectedCorner> some;
      for (std::size_t i = 0; i < kCorners; ++i)
        some.push_back(view.corners[i * view.corners.size() / kCorners]);
      view.corners = std::move(some);
    }
    sample.views.push_back(std::move(view));
  }
  return sample;
}

double Median(std::vector<double> values) {
  if (values.empty()) return HUGE_VAL;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// A state of one camera with the poses that suit it, and the upper quartile of the views' errors:
// more than the median, since a wrong shape shows in few views.
struct Trial {
  CalibrationState state;
  double score = HUGE_VAL;
  double focal_px = 0;
  const Shape* shape = nullptr;
};

Trial TryCamera(const Detections& sample, const CameraIntrinsics& intrinsics, int iterations) {
  Trial trial;
  trial.state.cameras = {intrinsics};
  trial.state.camera_from_rig = {kIdentityPose};
  trial.state.rig_from_target.resize(sample.exposures);
  const Camera camera(intrinsics);
  std::vector<double> errors;
  const double huber = 0.01 * intrinsics.width;
  for (const TargetView& view : sample.views) {
    const auto found = FindTargetPose(camera, PairsOf(trial.state, view), huber, iterations);
    errors.push_back(found ? found->rms_px : TargetPose::kFarOff);
    if (found && found->rms_px < 0.25 * intrinsics.width)
      trial.state.rig_from_target[view.exposure] = PoseOf(found->camera_from_target);
  }
  std::sort(errors.begin(), errors.end());
  if (!errors.empty()) trial.score = errors[errors.size() * 3 / 4];
  return trial;
}

// One solve of the sample under a prior; throws nothing numerical.
void Settle(const Registry& types, const Detections& sample, double prior_width,
            CalibrationState* state) {
  CalibrationOptions options;
  options.model = kFirstModel;
  options.camera_priors = {FirstPrior(state->cameras[0], prior_width)};
  options.solve.max_iterations = 50;
  options.solve.initial_trust_region_radius = 1e4;
  const Calibration solved = RefineCalibration(types, sample, *state, options);
  const std::vector<double>& p = solved.state.cameras[0].parameters;
  if (p[0] > 0 && p[1] > 0) *state = solved.state;
}

std::vector<Trial> CoarseTrials(const Detections& sample) {
  const ImageSize& size = sample.cameras[0];
  std::vector<Trial> trials;
  for (const Shape& shape : kShapes) {
    std::vector<Trial> row;
    // From the widest of fisheyes to a long lens, in steps of a fifth.
    for (double focal = 0.15 * size.width; focal < 8 * size.width; focal *= 1.2) {
      CameraIntrinsics camera{size.camera, kFirstModel, size.width, size.height, {}};
      camera.parameters = {focal, focal, (size.width - 1) / 2.0, (size.height - 1) / 2.0};
      camera.parameters.insert(camera.parameters.end(), shape.terms.begin(), shape.terms.end());
      row.push_back(TryCamera(sample, camera, 6));
      row.back().focal_px = focal;
      row.back().shape = &shape;
    }
    // Only what is better than its neighbours: the others lead to the same place.
    for (std::size_t i = 0; i < row.size(); ++i)
      if ((i == 0 || row[i].score <= row[i - 1].score) &&
          (i + 1 == row.size() || row[i].score <= row[i + 1].score))
        trials.push_back(std::move(row[i]));
  }
  std::stable_sort(trials.begin(), trials.end(),
                   [](const Trial& a, const Trial& b) { return a.score < b.score; });
  return trials;
}

}  // namespace

CornerPairs PairsOf(const CalibrationState& state, const TargetView& view) {
  CornerPairs pairs;
  for (const DetectedCorner& corner : view.corners) {
    pairs.in_target.push_back(PlaceOf(state, corner));
    pairs.pixels.emplace_back(corner.pixel[0], corner.pixel[1]);
  }
  return pairs;
}

CameraPrior FirstPrior(const CameraIntrinsics& camera, double width) {
  CameraPrior prior;
  const double f = std::sqrt(camera.parameters[0] * camera.parameters[1]);
  prior.mean = camera.parameters;
  prior.mean[0] = prior.mean[1] = f;
  prior.mean[2] = (camera.width - 1) / 2.0;
  prior.mean[3] = (camera.height - 1) / 2.0;
  const std::size_t n = prior.mean.size();
  // fx and fy: their sum known badly, their difference well.
  const double sum = 1 / std::pow(2 * f * width, 2), difference = 1 / std::pow(0.01 * f * width, 2);
  std::vector<double> upper;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) {
      double value = 0;
      if (i < 2 && j < 2) value = i == j ? sum + difference : sum - difference;
      if (i == j && (i == 2 || i == 3)) value = 1 / std::pow(0.02 * camera.width * width, 2);
      if (i == j && i >= 4) value = 1 / std::pow(0.05 * width, 2);
      upper.push_back(value);
    }
  prior.noise = Noise::Information(std::move(upper));
  return prior;
}

std::vector<FirstGuess> GuessCamera(const Registry& types, const Detections& detections,
                                    std::size_t camera) {
  constexpr std::size_t kTrials = 6;
  const std::vector<std::size_t> views = DifferentViews(detections, camera);
  if (views.empty()) return {};
  const Detections sample = Sample(detections, camera, views);
  std::vector<Trial> trials = CoarseTrials(sample);
  if (trials.size() > kTrials) trials.resize(kTrials);
  std::vector<FirstGuess> guesses;
  for (Trial& trial : trials) {
    for (const double width : {1.0, 5.0, 25.0}) {
      Settle(types, sample, width, &trial.state);
      // Poses from nowhere again: what was off at first may be well placed now.
      Trial again = TryCamera(sample, trial.state.cameras[0], 10);
      trial.state = std::move(again.state);
      trial.score = again.score;
    }
    std::vector<double> errors;
    for (const TargetView& view : sample.views) {
      double sum = 0;
      const auto residuals = ViewResiduals(trial.state, view);
      for (const Eigen::Vector2d& r : residuals)
        sum += std::isfinite(r.x()) ? r.squaredNorm() : TargetPose::kFarOff;
      errors.push_back(std::sqrt(sum / static_cast<double>(residuals.size())));
    }
    guesses.push_back({trial.state.cameras[0], Median(errors), trial.focal_px, trial.shape->name});
  }
  std::stable_sort(guesses.begin(), guesses.end(), [](const FirstGuess& a, const FirstGuess& b) {
    return a.median_px < b.median_px;
  });
  return guesses;
}

}  // namespace graticule
