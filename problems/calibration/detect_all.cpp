#include "graticule/problems/calibration/detect_all.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "graticule/io/bag_images.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/problems/calibration/guess_target.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

namespace fs = std::filesystem;

using Size = std::pair<std::size_t, std::size_t>;

std::string Text(const Size& size) {
  return std::to_string(size.first) + " x " + std::to_string(size.second);
}

/// Where images come from: files, or a video's frames.
class Source {
 public:
  Source(const std::vector<std::string>& images, const DetectAllOptions& options) : names_(images) {
    if (images.size() != 1 || !IsVideoName(images[0])) return;
    frames_ = fs::path(images[0]).extension() == ".bag"
                  ? ReadBagFrames(images[0], options.image_topic, options.video_frames)
                  : ReadVideoFrames(images[0], options.video_frames);
    names_.clear();
    for (std::size_t i = 0; i < frames_.size(); ++i)
      names_.push_back(images[0] + "#" + std::to_string(i));
  }

  std::size_t Size() const { return names_.size(); }
  const std::string& Path(std::size_t i) const { return names_[i]; }
  std::string Name(std::size_t i) const { return fs::path(names_[i]).filename().string(); }
  std::string File(std::size_t i) const { return frames_.empty() ? names_[i] : ""; }
  GreyImage Read(std::size_t i) const {
    return frames_.empty() ? ReadGreyPhoto(names_[i]) : frames_[i];
  }

 private:
  std::vector<std::string> names_;
  std::vector<GreyImage> frames_;
};

Target Guess(const Source& source) {
  // Evenly over all: cameras, too, come one after the other.
  constexpr std::size_t kMost = 12;
  std::vector<GreyImage> some;
  const std::size_t count = std::min(source.Size(), kMost);
  for (std::size_t i = 0; i < count; ++i) try {
      some.push_back(source.Read(i * source.Size() / count));
    } catch (const Error&) {
      // Listed later, with its reason.
    }
  const auto target = GuessTarget(some);
  if (!target)
    throw Error(
        "no calibration target was recognised in " + std::to_string(some.size()) + " of " +
        std::to_string(source.Size()) +
        " images: looked for mosaics and grids of AprilTags, ChArUco boards and chessboards; "
        "describe the target (--target FILE), or photograph it larger and sharper");
  return *target;
}

struct Found {
  Size size = {0, 0};
  std::vector<DetectedCorner> corners;
  std::string problem;
};

}  // namespace

std::vector<GreyImage> ReadBagFrames(const std::string& path, const std::string& topic,
                                     std::size_t most) {
  BagImages images(path, topic);
  const std::size_t step =
      std::max<std::size_t>(1, images.Count() / std::max<std::size_t>(most, 1));
  std::vector<GreyImage> frames;
  for (std::size_t i = 0; i < images.Count() && frames.size() < most; ++i) {
    if (i % step != 0)
      images.Skip();
    else if (auto image = images.Next())
      frames.push_back(std::move(*image));
  }
  return frames;
}

std::vector<GreyImage> ReadVideoFrames(const std::string& path, std::size_t most) {
  if (!fs::exists(path)) throw Error(path + ": No such file or directory");
  constexpr double kUnknownStep = 10;  // where the file does not say how many frames it has
  std::vector<GreyImage> frames;
  try {
    // These two say nothing on the terminal where they cannot.
    cv::VideoCapture video(path, cv::CAP_FFMPEG);
    if (!video.isOpened()) video.open(path, cv::CAP_OPENCV_MJPEG);
    if (!video.isOpened()) throw Error(path + ": expected a video that FFmpeg can read");
    const double count = video.get(cv::CAP_PROP_FRAME_COUNT);
    const double step =
        count > 0 ? std::max(1.0, count / static_cast<double>(std::max<std::size_t>(most, 1)))
                  : kUnknownStep;
    double next = 0;
    cv::Mat frame, grey;
    for (double i = 0; frames.size() < most && video.grab(); ++i) {
      if (i < next) continue;
      next += step;
      if (!video.retrieve(frame) || frame.empty()) continue;
      if (frame.channels() == 1)
        grey = frame;
      else
        cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
      GreyImage image;
      image.width = static_cast<std::size_t>(grey.cols);
      image.height = static_cast<std::size_t>(grey.rows);
      for (int row = 0; row < grey.rows; ++row)
        image.shades.insert(image.shades.end(), grey.ptr(row), grey.ptr(row) + grey.cols);
      frames.push_back(std::move(image));
    }
  } catch (const cv::Exception&) {
    throw Error(path + ": the video cannot be read");
  }
  if (frames.empty()) throw Error(path + ": the video has no frames");
  return frames;
}

FoundDetections DetectAll(const std::vector<std::string>& images, const DetectAllOptions& options,
                          const DetectProgress& progress) {
  if (images.empty()) throw Error("expected images", ErrorKind::kUsage);
  const Source source(images, options);
  FoundDetections result;
  result.is_guessed = !options.target;
  result.target = options.target ? *options.target : Guess(source);
  const TargetDetector detector(result.target, options.detect);

  std::vector<Found> found(source.Size());
  std::mutex mutex;
  std::size_t done = 0;
  const std::size_t threads =
      options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  ParallelFor(source.Size(), threads, [&](std::size_t, std::size_t i) {
    try {
      const GreyImage image = source.Read(i);
      found[i].size = {image.width, image.height};
      found[i].corners = detector.Detect(image);
    } catch (const Error& error) {
      // Its own name comes first in every message.
      const std::string what = error.what(), own = source.Path(i) + ": ";
      found[i].problem = what.compare(0, own.size(), own) == 0 ? what.substr(own.size()) : what;
    } catch (const cv::Exception&) {
      found[i].problem = "OpenCV could not look for corners in it";
    }
    const std::lock_guard<std::mutex> lock(mutex);
    if (progress) progress(++done, source.Size());
  });

  // The size that most images with corners have.
  std::map<Size, std::size_t> sizes;
  for (const Found& one : found)
    if (one.size.first) sizes[one.size] += one.corners.empty() ? 1 : found.size() + 1;
  if (sizes.empty())
    throw Error("none of " + std::to_string(found.size()) +
                " images can be read; the first: " + source.Path(0) + ": " + found[0].problem);
  const Size size = std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
                      return a.second < b.second;
                    })->first;

  Detections& detections = result.detections;
  detections.cameras.push_back(
      {options.camera, static_cast<int>(size.first), static_cast<int>(size.second)});
  for (std::size_t i = 0; i < found.size(); ++i) {
    Found& one = found[i];
    if (one.problem.empty() && one.size != size)
      one.problem = "its size is " + Text(one.size) + ", that of most is " + Text(size);
    if (one.problem.empty() && one.corners.empty()) one.problem = "the target was not found in it";
    if (!one.problem.empty()) {
      result.skipped.push_back({source.Path(i), one.problem});
      continue;
    }
    result.files.push_back(source.File(i));
    detections.views.push_back({source.Name(i), 0, detections.exposures++, std::move(one.corners)});
  }
  if (detections.views.empty())
    throw Error("the target (" + Described(result.target) + ") is in none of " +
                std::to_string(found.size()) + " images");
  return result;
}

FoundDetections DetectCameras(const std::vector<CameraImages>& cameras,
                              const DetectAllOptions& options, const DetectProgress& progress) {
  DetectAllOptions own = options;
  if (cameras.size() == 1) {
    own.camera = cameras[0].camera;
    return DetectAll(cameras[0].images, own, progress);
  }
  std::vector<std::string> all;
  for (const CameraImages& camera : cameras)
    all.insert(all.end(), camera.images.begin(), camera.images.end());
  FoundDetections result;
  result.is_guessed = !options.target;
  if (result.is_guessed) own.target = Guess(Source(all, options));
  result.target = *own.target;

  std::vector<Detections> parts;
  std::vector<std::string> names;
  std::size_t before = 0;
  for (const CameraImages& camera : cameras) {
    own.camera = camera.camera;
    FoundDetections found = DetectAll(camera.images, own, [&](std::size_t done, std::size_t) {
      if (progress) progress(before + done, all.size());
    });
    before += camera.images.size();
    parts.push_back(std::move(found.detections));
    names.push_back(camera.images.front());
    result.files.insert(result.files.end(), found.files.begin(), found.files.end());
    result.skipped.insert(result.skipped.end(), found.skipped.begin(), found.skipped.end());
  }
  result.detections = CombineCameras(std::move(parts), names);
  return result;
}

}  // namespace graticule
