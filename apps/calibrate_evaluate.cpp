#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "calibration_input.hpp"
#include "commands.hpp"
#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/camera_file.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/calibration/difference.hpp"
#include "graticule/problems/calibration/evaluate.hpp"
#include "graticule/problems/calibration/picture_data.hpp"
#include "outputs.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

// The cameras of a file as a state without targets, for images of the test set's sizes.
CalibrationState StateOf(const std::string& file, const Detections& test) {
  const CameraRig rig = ReadCameras(file);
  if (test.cameras.size() != rig.cameras.size())
    throw Error(fmt::format("{} has {} cameras, the test set {}", file, rig.cameras.size(),
                            test.cameras.size()),
                ErrorKind::kUsage);
  CalibrationState state;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    CameraIntrinsics camera = rig.cameras[c].intrinsics;
    const ImageSize& size = test.cameras[c];
    if (camera.width == 0 && camera.height == 0) {
      camera.width = size.width;
      camera.height = size.height;
    }
    if (camera.width != size.width || camera.height != size.height)
      throw Error(fmt::format("{}: its images have {} x {} pixels, the test set's {} x {}", file,
                              camera.width, camera.height, size.width, size.height));
    state.cameras.push_back(std::move(camera));
    state.camera_from_rig.push_back(rig.cameras[c].camera_from_rig);
  }
  return state;
}

nlohmann::ordered_json ErrorJson(const ReprojectionError& error) {
  return {{"views", error.views},
          {"corners", error.corners},
          {"unseen", error.unseen},
          {"mean_px", error.mean_px},
          {"rms_px", error.rms_px},
          {"median_px", error.median_px},
          {"percentile_995_px", error.percentile_995_px},
          {"max_px", error.max_px}};
}

// The picture of camera c: the path itself where there is one camera.
std::string PictureFile(const std::string& path, std::size_t camera, std::size_t cameras) {
  if (cameras == 1) return path;
  const std::size_t dot = path.rfind('.');
  return path.substr(0, dot) + "." + std::to_string(camera) + path.substr(dot);
}

}  // namespace

int Run(const CalibrateEvaluateCommand& command, const Console& console) {
  if (!command.picture.empty()) {
    if (command.against.empty()) throw Error("--plot goes with --against", ErrorKind::kUsage);
    ExpectEnding(command.picture, "--plot", {".svg", ".png"});
    ExpectWritable(command.picture);
  }
  Outputs outputs(console);
  LoadTypes(command.reading);  // for the lenses
  const Detections test =
      LoadCalibrationInput(command.sources, command.target, command.image_topic, console)
          .detections;
  const CalibrationState state = StateOf(command.camera, test);
  const ReprojectionError error = EvaluateOn(state, test);
  nlohmann::ordered_json json = {{"test", ErrorJson(error)}};
  if (!command.json)
    fmt::print(
        "{}\n  the target's pose is optimised for every view, the camera stays as it is\n"
        "  error         mean {:.4f} px, rms {:.4f}, median {:.4f}, 99.5 % {:.4f}, max {:.4f}\n"
        "  corners       {} in {} views; {} that the model has no image of\n",
        Described(test), error.mean_px, error.rms_px, error.median_px, error.percentile_995_px,
        error.max_px, error.corners, error.views, error.unseen);
  if (!command.against.empty()) {
    const CalibrationState other = StateOf(command.against, test);
    for (std::size_t c = 0; c < state.cameras.size(); ++c) {
      const CalibrationDifference difference =
          Difference(Camera(state.cameras[c]), Camera(other.cameras[c]));
      json["differences"].push_back(
          {{"camera", state.cameras[c].name},
           {"mean_px", difference.mean_px},
           {"rms_px", difference.rms_px},
           {"percentile_995_px", difference.percentile_995_px},
           {"max_px", difference.max_px},
           {"max_at_px", {difference.max_at.x(), difference.max_at.y()}}});
      if (!command.json)
        fmt::print(
            "  difference    mean {:.4f} px, 99.5 % {:.4f}, max {:.4f} at ({:.0f}, {:.0f}), the "
            "best rotation taken out\n",
            difference.mean_px, difference.percentile_995_px, difference.max_px,
            difference.max_at.x(), difference.max_at.y());
      if (command.picture.empty()) continue;
      const std::string svg = DrawErrorMap(DescribeDifference(difference, command.against));
      const std::string file = PictureFile(command.picture, c, state.cameras.size());
      outputs.Try(file,
                  [&] { WriteFile(file, Ending(file) == ".png" ? PngFromSvg(svg, 1000) : svg); });
    }
  }
  if (command.json) fmt::print("{}\n", JsonText(json, 2));
  return outputs.Failure();
}

}  // namespace graticule::apps
