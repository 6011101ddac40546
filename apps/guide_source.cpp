#include "guide_source.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <set>
#include <thread>

#include "graticule/io/frame_reader.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/problems/calibration/detect_all.hpp"
#include "graticule/problems/calibration/render.hpp"
#include "graticule/problems/calibration/simulated_person.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::apps {
namespace {

using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Frames of a film, shown at its rate.
class Pace {
 public:
  Pace(double rate, bool is_live) : rate_(rate), is_live_(is_live) {}
  /// When the next frame is due, which is waited for.
  double Next() {
    const double due = static_cast<double>(count_++) / rate_;
    if (!is_live_) return due;
    if (count_ == 1) start_ = Clock::now();
    std::this_thread::sleep_until(
        start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(due)));
    // Who cannot keep up gets slower pictures, not a burst of them later.
    if (const double late = Since(start_) - due; late > 0.2)
      start_ += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(late));
    return due;
  }

 private:
  double rate_;
  bool is_live_;
  std::size_t count_ = 0;
  Clock::time_point start_;
};

// A frame that was read to learn the pictures' size is shown, too.
class FilmSource : public GuideSource {
 public:
  FilmSource(FrameReader reader, const std::string& name, bool is_camera, bool is_live)
      : reader_(std::move(reader)),
        name_(name),
        is_camera_(is_camera),
        is_live_(is_live),
        pace_(reader_.Rate(), is_live),
        first_(reader_.Next()) {
    if (!first_) throw Error(name + ": no frame could be read", ErrorKind::kInput);
    width_ = first_->width;
    height_ = first_->height;
  }

  ImageSize Size() const override {
    return {"cam0", static_cast<int>(width_), static_cast<int>(height_)};
  }
  bool IsAtEnd() const override { return is_at_end_; }
  std::optional<SourceFrame> Next(const Guidance&, bool) override {
    std::optional<GreyImage> image = first_ ? std::move(first_) : reader_.Next();
    first_.reset();
    if (!image && is_camera_) throw Error(name_ + ": no frame came: was it unplugged?");
    if (!image) {
      is_at_end_ = true;
      if (!is_live_) return std::nullopt;
      image = last_;
    }
    if (image->width != width_ || image->height != height_)
      throw Error(name_ + ": the size of its frames changed");
    // A camera waits by itself.
    const double seconds = is_camera_ ? Since(start_) : pace_.Next();
    if (!is_camera_ && is_live_) last_ = *image;
    return SourceFrame{std::move(*image), seconds, std::nullopt, false};
  }

 private:
  FrameReader reader_;
  std::string name_;
  bool is_camera_, is_live_;
  Pace pace_;
  std::optional<GreyImage> first_;
  GreyImage last_;
  std::atomic<bool> is_at_end_{false};
  std::size_t width_ = 0, height_ = 0;
  Clock::time_point start_ = Clock::now();
};

// Pictures of a folder, each chosen by whoever took it; where it is live, those that are still to
// be taken, too (a camera on a cable).
class FolderSource : public GuideSource {
 public:
  FolderSource(const std::string& folder, bool is_live)
      : folder_(folder), is_live_(is_live), shown_(FirstReadable(Pictures())) {}

  ImageSize Size() const override {
    return {"cam0", static_cast<int>(shown_.width), static_cast<int>(shown_.height)};
  }
  std::optional<SourceFrame> Next(const Guidance&, bool) override {
    const double seconds = Since(start_);
    for (const std::string& path : Pictures()) {
      if (!seen_.insert(path).second) continue;
      GreyImage image;
      try {
        image = ReadGreyPhoto(path);
      } catch (const Error&) {
        // It may be on its way to the disk.
        if (is_live_ && ++tries_[path] < 5) {
          seen_.erase(path);
          break;
        }
        continue;
      }
      if (image.width != shown_.width || image.height != shown_.height) continue;
      shown_ = std::move(image);
      return SourceFrame{shown_, seconds, std::nullopt, true};
    }
    if (!is_live_) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return SourceFrame{shown_, seconds, std::nullopt, false};
  }

 private:
  std::vector<std::string> Pictures() const { return ExpandImages({folder_}); }
  static GreyImage FirstReadable(const std::vector<std::string>& pictures) {
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) {
      try {
        return ReadGreyPhoto(pictures[i]);
      } catch (const Error&) {
      }
    }
    return ReadGreyPhoto(pictures.back());
  }

  std::string folder_;
  bool is_live_;
  GreyImage shown_;
  std::set<std::string> seen_;
  std::map<std::string, int> tries_;
  Clock::time_point start_ = Clock::now();
};

CameraIntrinsics LensOf(const std::string& word) {
  std::string names;
  for (const StudyLens& lens : StudyLenses()) {
    if (lens.name.substr(0, 1) == word) return lens.camera;
    names += (names.empty() ? "" : ", ") + lens.name;
  }
  throw Error("--lens " + word + ": expected the letter of one of " + names, ErrorKind::kUsage);
}

// Someone who does what the page says, before a camera that is known.
class SimulatedSource : public GuideSource {
 public:
  SimulatedSource(const CalibrateGuideCommand& command, const Target& target, bool is_live)
      : truth_(LensOf(command.lens)),
        layout_(LayoutOf(target)),
        is_rendered_(command.simulate != "corners"),
        renderer_(target, truth_, Rendering(command)),
        person_(truth_, layout_, Person(command)),
        random_(command.seed, 1),
        pace_(kRate, is_live) {}

  ImageSize Size() const override { return {"cam0", truth_.Width(), truth_.Height()}; }
  const CameraIntrinsics* Truth() const override { return &truth_.Intrinsics(); }

  std::optional<SourceFrame> Next(const Guidance& guidance, bool is_watched) override {
    SourceFrame frame;
    frame.seconds = pace_.Next();
    const Se3Array pose = person_.Step(guidance.suggestion, guidance.number, 1 / kRate);
    if (is_rendered_ || is_watched) frame.image = renderer_.Render(pose, &random_);
    if (!is_rendered_) {
      frame.corners = VisibleCorners(truth_, layout_, pose);
      AddPixelNoise(kCornerSigmaPx, random_, &*frame.corners);
    }
    return frame;
  }

 private:
  static constexpr double kRate = 30, kCornerSigmaPx = 0.1;

  static RenderOptions Rendering(const CalibrateGuideCommand& command) {
    RenderOptions options;
    options.blur_px = command.blur_px;
    options.noise = command.noise;
    return options;
  }
  static PersonOptions Person(const CalibrateGuideCommand& command) {
    PersonOptions options;
    options.seed = command.seed;
    return options;
  }

  Camera truth_;
  TargetLayout layout_;
  bool is_rendered_;
  TargetRenderer renderer_;
  SimulatedPerson person_;
  RandomNumbers random_;
  Pace pace_;
};

}  // namespace

std::unique_ptr<GuideSource> OpenSource(const CalibrateGuideCommand& command, const Target& target,
                                        bool is_live) {
  const int given = (command.camera >= 0) + !command.video.empty() + !command.folder.empty() +
                    !command.simulate.empty();
  if (given > 1)
    throw Error("calibrate guide: expected one of --camera, --video, --folder and --simulate",
                ErrorKind::kUsage);
  if (!command.simulate.empty()) return std::make_unique<SimulatedSource>(command, target, is_live);
  if (std::filesystem::path(command.video).extension() == ".bag")
    return std::make_unique<FilmSource>(FrameReader::OfBag(command.video, command.image_topic),
                                        command.video, false, is_live);
  if (!command.video.empty())
    return std::make_unique<FilmSource>(FrameReader::OfVideo(command.video), command.video, false,
                                        is_live);
  if (!command.folder.empty()) return std::make_unique<FolderSource>(command.folder, is_live);
  const int number = std::max(0, command.camera);
  return std::make_unique<FilmSource>(FrameReader::OfCamera(number, command.width, command.height),
                                      "camera " + std::to_string(number), true, is_live);
}

}  // namespace graticule::apps
