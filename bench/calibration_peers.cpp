// Held-out error of recorded sets: OpenCV's calibrateCamera and fisheye beside ours, on the same
// corners and the same five folds, every one evaluated in the thesis' way (section 5.5: the poses
// of the views that were left out optimised, the camera as it was found).
//
//   graticule_calibration_peers FILE...     recorded detections, one camera each

#include <fmt/core.h>

#include <opencv2/calib3d.hpp>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/bootstrap.hpp"
#include "graticule/problems/calibration/select_model.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kFolds = 5;

struct Split {
  Detections train, test;
};

Split Fold(const Detections& all, std::size_t fold) {
  Split split{all, all};
  split.train.views.clear();
  split.test.views.clear();
  for (const TargetView& view : all.views)
    (view.exposure % kFolds == fold ? split.test : split.train).views.push_back(view);
  return split;
}

// OpenCV's answer as a camera of ours; throws what OpenCV throws.
CameraIntrinsics ByOpenCv(const Detections& detections, bool is_fisheye) {
  std::vector<std::vector<cv::Point3f>> places;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const TargetView& view : detections.views) {
    if (view.corners.size() < 6) continue;
    places.emplace_back();
    pixels.emplace_back();
    for (const DetectedCorner& corner : view.corners) {
      places.back().emplace_back(static_cast<float>(corner.in_target[0]),
                                 static_cast<float>(corner.in_target[1]), 0.f);
      pixels.back().emplace_back(static_cast<float>(corner.pixel[0]),
                                 static_cast<float>(corner.pixel[1]));
    }
  }
  const ImageSize& size = detections.cameras[0];
  cv::Mat k, d;
  std::vector<cv::Mat> turns, moves;
  if (is_fisheye)
    cv::fisheye::calibrate(places, pixels, {size.width, size.height}, k, d, turns, moves,
                           cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW);
  else
    cv::calibrateCamera(places, pixels, {size.width, size.height}, k, d, turns, moves);
  CameraIntrinsics camera{
      size.camera,
      is_fisheye ? "angular4" : "brown5",
      size.width,
      size.height,
      {k.at<double>(0, 0), k.at<double>(1, 1), k.at<double>(0, 2), k.at<double>(1, 2)}};
  for (int i = 0; i < (is_fisheye ? 4 : 5); ++i) camera.parameters.push_back(d.at<double>(i));
  return camera;
}

// Held-out error over the folds; "fails" where a fold has no camera.
template <class Calibrator>
std::string HeldOut(const Detections& all, const Calibrator& calibrate) {
  std::vector<double> distances;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const Split split = Fold(all, fold);
    try {
      std::vector<std::vector<double>> of_views;
      EvaluateOn(calibrate(split.train), split.test, &of_views);
      for (const auto& view : of_views) distances.insert(distances.end(), view.begin(), view.end());
    } catch (const std::exception&) {
      return "fails";
    }
  }
  const ReprojectionError error = SummariseErrors(&distances);
  return fmt::format("{:.4f} / {:.4f}", error.rms_px, error.mean_px);
}

CalibrationState OfCamera(const CameraIntrinsics& camera) {
  CalibrationState state;
  state.cameras = {camera};
  state.camera_from_rig = {kIdentityPose};
  return state;
}

void AddRow(const std::string& file, const Registry& types) {
  const Detections all = ReadDetections({file});
  const auto ours = [&](const char* model, BoardShape board) {
    return HeldOut(all, [&](const Detections& train) {
      CalibrationOptions options;
      options.model = model;
      options.board = board;
      return BootstrapCalibration(types, train, options).state;
    });
  };
  fmt::print("| {} | {} | {} | {} | {} |", all.cameras[0].camera,
             HeldOut(all, [](const Detections& d) { return OfCamera(ByOpenCv(d, false)); }),
             ours("brown5", BoardShape::kFlat),
             HeldOut(all, [](const Detections& d) { return OfCamera(ByOpenCv(d, true)); }),
             ours("angular4", BoardShape::kFlat));
  const ModelSelection best =
      SelectModel(types, all, {}, {}, {BoardShape::kFlat, BoardShape::kWarped, BoardShape::kFree});
  const std::string model = best.options.model;
  fmt::print(" {} ({}, {}) |\n", ours(model.c_str(), best.options.board), model,
             BoardShapeName(best.options.board));
  std::fflush(stdout);
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  const Registry types = Builtins();
  fmt::print(
      "Held-out rms / mean [px], five folds\n\n| set | OpenCV, 5 terms | brown5, flat | OpenCV "
      "fisheye | angular4, flat | chosen |\n|---|---|---|---|---|---|\n");
  for (int i = 1; i < argc; ++i) try {
      AddRow(argv[i], types);
    } catch (const Error& error) {
      fmt::print("| {} | {} |\n", argv[i], error.what());
    }
  return 0;
}
