#include "graticule/io/frame_reader.hpp"

#include <cmath>
#include <cstring>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "graticule/io/bag_images.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

class FrameReader::Source {
 public:
  virtual ~Source() = default;
  virtual std::optional<GreyImage> Next() = 0;
  virtual double Rate() const = 0;
};

class FrameReader::Capture : public Source {
 public:
  // OpenCV throws where it cannot open, or says nothing.  The one reader that can is named: asked
  // for any, it loads a dozen others, which leak.
  template <class Source>
  Capture(const Source& source, int reader, const std::string& name, const std::string& what) {
    // What it tries by itself and fails at, it prints.
    const auto level =
        cv::utils::logging::setLogLevel(cv::utils::logging::LogLevel::LOG_LEVEL_SILENT);
    try {
      capture_.open(source, reader);
    } catch (const cv::Exception&) {
    }
    cv::utils::logging::setLogLevel(level);
    if (!capture_.isOpened()) throw Error(name + ": " + what, ErrorKind::kInput);
  }

  void AskFor(int width, int height) {
    if (width > 0) capture_.set(cv::CAP_PROP_FRAME_WIDTH, width);
    if (height > 0) capture_.set(cv::CAP_PROP_FRAME_HEIGHT, height);
    // An old frame shows where the target was.
    capture_.set(cv::CAP_PROP_BUFFERSIZE, 1);
  }

  std::optional<GreyImage> Next() override {
    try {
      if (!capture_.read(frame_) || frame_.empty()) return std::nullopt;
      if (frame_.channels() == 1)
        grey_ = frame_;
      else
        cv::cvtColor(frame_, grey_, cv::COLOR_BGR2GRAY);
    } catch (const cv::Exception&) {
      return std::nullopt;
    }
    if (grey_.depth() != CV_8U) return std::nullopt;
    GreyImage image;
    image.width = static_cast<std::size_t>(grey_.cols);
    image.height = static_cast<std::size_t>(grey_.rows);
    image.shades.resize(image.width * image.height);
    for (int row = 0; row < grey_.rows; ++row)
      std::memcpy(&image.shades[static_cast<std::size_t>(row) * image.width], grey_.ptr(row),
                  image.width);
    return image;
  }

  double Rate() const override {
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    constexpr double kUsual = 30, kMost = 1000;
    return std::isfinite(rate) && rate > 0 && rate <= kMost ? rate : kUsual;
  }

 private:
  cv::VideoCapture capture_;
  cv::Mat frame_, grey_;
};

class FrameReader::Bag : public Source {
 public:
  Bag(const std::string& path, const std::string& topic) : images_(path, topic) {}

  std::optional<GreyImage> Next() override { return images_.Next(); }
  double Rate() const override { return images_.Rate(); }

 private:
  BagImages images_;
};

FrameReader::FrameReader(std::unique_ptr<Source> source) : source_(std::move(source)) {}
FrameReader::FrameReader(FrameReader&&) noexcept = default;
FrameReader::~FrameReader() = default;

FrameReader FrameReader::OfCamera(int number, int width, int height) {
  auto capture = std::make_unique<Capture>(number, cv::CAP_V4L2, "camera " + std::to_string(number),
                                           "there is no such camera, or another program has it");
  capture->AskFor(width, height);
  return FrameReader(std::move(capture));
}

FrameReader FrameReader::OfVideo(const std::string& path) {
  return FrameReader(std::make_unique<Capture>(path, cv::CAP_FFMPEG, path,
                                               "no video, or none that OpenCV can read"));
}

FrameReader FrameReader::OfBag(const std::string& path, const std::string& topic) {
  return FrameReader(std::make_unique<Bag>(path, topic));
}

std::optional<GreyImage> FrameReader::Next() { return source_->Next(); }
double FrameReader::Rate() const { return source_->Rate(); }

}  // namespace graticule
