#include "graticule/io/frame_reader.hpp"

#include <cmath>
#include <cstring>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "graticule/solver/error.hpp"

namespace graticule {

class FrameReader::Capture {
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

  cv::VideoCapture& Get() { return capture_; }
  cv::Mat frame, grey;

 private:
  cv::VideoCapture capture_;
};

FrameReader::FrameReader(std::unique_ptr<Capture> capture) : capture_(std::move(capture)) {}
FrameReader::FrameReader(FrameReader&&) noexcept = default;
FrameReader::~FrameReader() = default;

FrameReader FrameReader::OfCamera(int number, int width, int height) {
  auto capture = std::make_unique<Capture>(number, cv::CAP_V4L2, "camera " + std::to_string(number),
                                           "there is no such camera, or another program has it");
  if (width > 0) capture->Get().set(cv::CAP_PROP_FRAME_WIDTH, width);
  if (height > 0) capture->Get().set(cv::CAP_PROP_FRAME_HEIGHT, height);
  // An old frame shows where the target was.
  capture->Get().set(cv::CAP_PROP_BUFFERSIZE, 1);
  return FrameReader(std::move(capture));
}

FrameReader FrameReader::OfVideo(const std::string& path) {
  return FrameReader(std::make_unique<Capture>(path, cv::CAP_FFMPEG, path,
                                               "no video, or none that OpenCV can read"));
}

std::optional<GreyImage> FrameReader::Next() {
  try {
    if (!capture_->Get().read(capture_->frame) || capture_->frame.empty()) return std::nullopt;
    if (capture_->frame.channels() == 1)
      capture_->grey = capture_->frame;
    else
      cv::cvtColor(capture_->frame, capture_->grey, cv::COLOR_BGR2GRAY);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (capture_->grey.depth() != CV_8U) return std::nullopt;
  GreyImage image;
  image.width = static_cast<std::size_t>(capture_->grey.cols);
  image.height = static_cast<std::size_t>(capture_->grey.rows);
  image.shades.resize(image.width * image.height);
  for (int row = 0; row < capture_->grey.rows; ++row)
    std::memcpy(&image.shades[static_cast<std::size_t>(row) * image.width], capture_->grey.ptr(row),
                image.width);
  return image;
}

double FrameReader::Rate() const {
  const double rate = capture_->Get().get(cv::CAP_PROP_FPS);
  constexpr double kUsual = 30, kMost = 1000;
  return std::isfinite(rate) && rate > 0 && rate <= kMost ? rate : kUsual;
}

}  // namespace graticule
