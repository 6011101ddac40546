#include "calibration_input.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "graticule/io/readable.hpp"
#include "graticule/problems/calibration/detect_all.hpp"
#include "graticule/solver/error.hpp"
#include "problem.hpp"

namespace graticule::apps {

namespace {

bool IsRecorded(const std::string& source) {
  const std::string ending = Ending(source);
  return ending == ".json" || ending == ".vnl" || ending == ".orpc" || ending == ".dsc" ||
         ending == ".tp";
}

}  // namespace

CalibrationInput LoadCalibrationInput(const std::vector<std::string>& sources,
                                      const std::string& target, const std::string& image_topic,
                                      const Console& console,
                                      const std::function<void()>& after_image) {
  if (sources.empty())
    throw Error("expected recorded detections, or images to look for a target in",
                ErrorKind::kUsage);
  const auto recorded = std::count_if(sources.begin(), sources.end(), IsRecorded);
  if (recorded > 0 && recorded < static_cast<std::ptrdiff_t>(sources.size()))
    throw Error("recorded detections and images do not go together", ErrorKind::kUsage);
  CalibrationInput input;
  if (recorded > 0) {
    if (!target.empty())
      throw Error("--target is for images: recorded detections say where corners are",
                  ErrorKind::kUsage);
    input.detections = ReadDetections(sources);
    return input;
  }
  DetectAllOptions options;
  options.image_topic = image_topic;
  if (!target.empty()) options.target = ReadTarget(target);
  const auto [cameras, strays] = GroupByCamera(ExpandImages(sources));
  FoundDetections found = DetectCameras(cameras, options, [&](std::size_t done, std::size_t all) {
    console.Progress(fmt::format("looking for the target: {} of {}", done, all));
    if (after_image) after_image();
  });
  console.Progress("");
  input.detections = std::move(found.detections);
  input.files = std::move(found.files);
  input.target = found.target;
  if (cameras.size() > 1) {
    std::string names;
    for (const CameraImages& camera : cameras) names += (names.empty() ? "" : ", ") + camera.camera;
    input.notes.push_back("by their names these are images of several cameras: " + names);
  }
  for (const std::string& stray : strays)
    input.notes.push_back(stray + ": its name belongs to none of the cameras");
  if (found.is_guessed)
    input.notes.push_back(fmt::format(
        "the target was guessed from the images: {}; what its size is they do not say (--target){}",
        Described(found.target),
        cameras.size() > 1 ? ", nor then how far the cameras are apart" : ""));
  for (const SkippedImage& skipped : found.skipped)
    input.notes.push_back(fmt::format("{}: {}", skipped.image, skipped.reason));
  return input;
}

std::string Described(const Detections& detections) {
  std::string text;
  for (std::size_t c = 0; c < detections.cameras.size(); ++c) {
    std::size_t views = 0, corners = 0;
    for (const TargetView& view : detections.views) {
      if (view.camera != c) continue;
      ++views;
      corners += view.corners.size();
    }
    const ImageSize& size = detections.cameras[c];
    text += fmt::format("{}{} ({} x {}): {} views, {} corners", c > 0 ? "; " : "", size.camera,
                        size.width, size.height, views, ReadableCount(corners));
  }
  return text;
}

}  // namespace graticule::apps
