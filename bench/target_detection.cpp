// What detection finds in the recorded images, beside the corners that were recorded of them, and
// how long it takes in CPU time of one thread: the tables of docs/calibration_targets.md.
//
//   graticule_target_detection [FOLDER of the recorded images]

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "graticule/io/photo.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/calibration/detect_all.hpp"
#include "graticule/problems/calibration/print_target.hpp"

namespace graticule {
namespace {

using Points = std::vector<std::vector<cv::Point2f>>;

/// Of this process: the machine may have other work.
double CpuMilliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Set {
  const char* name;
  const char* images;
  const char* recorded;
  bool is_fisheye;
};

constexpr Set kSets[] = {
    {"opencv_samples left", "opencv_samples/images", "opencv_samples/detections/opencv_left.json",
     false},
    {"opencv_samples right", "opencv_samples/images", "opencv_samples/detections/opencv_right.json",
     false},
    {"tumvi_aprilgrid", "tumvi_aprilgrid/images",
     "tumvi_aprilgrid/detections/tumvi_aprilgrid6.json", true},
    {"charuco 1280", "photonvision_charuco/2024-05-07_lifecam_1280",
     "photonvision_charuco/detections/pv_charuco_2024-05-07_lifecam_1280.json", false},
    {"charuco 640", "photonvision_charuco/2024-05-07_lifecam_480",
     "photonvision_charuco/detections/pv_charuco_2024-05-07_lifecam_480.json", false},
    {"charuco 1280, legacy", "photonvision_charuco/2024-06-19_lifecam_1280_Old_Pattern",
     "photonvision_charuco/detections/pv_charuco_2024-06-19_lifecam_1280_Old_Pattern.json", false},
    {"charuco 640, legacy", "photonvision_charuco/2024-06-19_lifecam_480_Old_Pattern",
     "photonvision_charuco/detections/pv_charuco_2024-06-19_lifecam_480_Old_Pattern.json", false},
};

/// The image of a recorded view: some were renamed.
std::string ImageOf(const std::string& folder, std::string name) {
  if (const std::size_t at = name.find("_1024"); at != std::string::npos)
    name = name.substr(0, at) + ".png";
  if (name == "d511.png") name = "1520525725372653511.png";
  return folder + "/" + name;
}

/// Root mean square of cv::calibrateCamera with five terms.
double CalibrationRms(const std::vector<std::vector<cv::Point3f>>& places, const Points& pixels,
                      const ImageSize& size) {
  cv::Mat k, d;
  std::vector<cv::Mat> r, t;
  return cv::calibrateCamera(places, pixels, {size.width, size.height}, k, d, r, t);
}

void Measure(const std::string& root, const Set& set) {
  const Detections recorded = ReadDetections({root + "/" + set.recorded});
  std::vector<std::string> paths;
  std::vector<GreyImage> images;
  for (const TargetView& view : recorded.views) {
    paths.push_back(ImageOf(root + "/" + set.images, view.image));
    images.push_back(ReadGreyPhoto(paths.back()));
  }
  const Target target = DetectAll(paths, {}).target;
  double ms[2] = {};
  std::vector<std::vector<DetectedCorner>> found(images.size());
  for (const int quick : {1, 0}) {
    const TargetDetector detector(target, {quick ? 2.0 : 1.0});
    detector.Detect(images[0]);
    const double start = CpuMilliseconds();
    for (std::size_t i = 0; i < images.size(); ++i) found[i] = detector.Detect(images[i]);
    ms[quick] = (CpuMilliseconds() - start) / static_cast<double>(images.size());
  }

  std::size_t frames = 0, corners = 0, all = 0, common = 0;
  double mean[2] = {}, squares = 0;
  std::vector<std::vector<cv::Point3f>> places;
  Points ours, theirs;
  for (std::size_t i = 0; i < images.size(); ++i) {
    frames += !found[i].empty();
    corners += found[i].size();
    all += recorded.views[i].corners.size();
    std::map<int, DetectedCorner> known;
    for (const DetectedCorner& corner : recorded.views[i].corners) known[corner.id] = corner;
    places.emplace_back();
    ours.emplace_back();
    theirs.emplace_back();
    for (const DetectedCorner& corner : found[i]) {
      const auto other = known.find(corner.id);
      if (other == known.end()) continue;
      ++common;
      const auto& p = corner.pixel;
      const auto& q = other->second.pixel;
      for (const std::size_t k : {0u, 1u}) {
        mean[k] += p[k] - q[k];
        squares += (p[k] - q[k]) * (p[k] - q[k]);
      }
      places.back().emplace_back(other->second.in_target[0], other->second.in_target[1], 0);
      ours.back().emplace_back(p[0], p[1]);
      theirs.back().emplace_back(q[0], q[1]);
    }
  }
  const auto n = static_cast<double>(common);
  const double rms = std::sqrt((squares - (mean[0] * mean[0] + mean[1] * mean[1]) / n) / n);
  const std::string fit =
      set.is_fisheye
          ? "-"
          : fmt::format("{:.3f} / {:.3f}", CalibrationRms(places, theirs, recorded.cameras[0]),
                        CalibrationRms(places, ours, recorded.cameras[0]));
  fmt::print("| {} | {} | {} of {} | {} / {} | {:.3f} | {:+.2f} {:+.2f} | {} | {:.1f} / {:.1f} |\n",
             set.name, Described(target), frames, images.size(), corners, all, rms, mean[0] / n,
             mean[1] / n, fit, ms[0], ms[1]);
}

// A page of the mosaic that fills a picture of this size.
void MeasureMosaic(int width, int height) {
  TargetRequest request;
  request.paper = {420, 420.0 * height / width};
  const Target target = FitTarget(request);
  const GreyImage image =
      ParseGreyPhoto(PngFromSvg(PrintTargetSvg(target, request.paper), width), "page.png");
  double ms[2] = {};
  std::size_t corners = 0;
  for (const int quick : {0, 1}) {
    const TargetDetector detector(target, {quick ? 2.0 : 1.0});
    detector.Detect(image);
    constexpr int kRepeats = 20;
    const double start = CpuMilliseconds();
    for (int i = 0; i < kRepeats; ++i) corners = detector.Detect(image).size();
    ms[quick] = (CpuMilliseconds() - start) / kRepeats;
  }
  fmt::print("| {} x {}, {} tags | {} of {} | {:.1f} / {:.1f} |\n", image.width, image.height,
             target.columns * target.rows, corners, 4 * target.columns * target.rows, ms[0], ms[1]);
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  cv::setNumThreads(1);
  const std::string root = argc > 1 ? argv[1] : GRATICULE_DATA_DIR "/calib";
  try {
    fmt::print(
        "| set | guessed | frames | corners: found / recorded | distance [px] | mean offset "
        "[px] | calibrateCamera's RMS: recorded / ours | CPU ms an image: decimate 1 / 2 |\n"
        "|---|---|---|---|---|---|---|---|\n");
    for (const Set& set : kSets) Measure(root, set);
    fmt::print("\n| mosaic | corners | CPU ms an image: decimate 1 / 2 |\n|---|---|---|\n");
    MeasureMosaic(640, 480);
    MeasureMosaic(1280, 960);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
