#pragma once

#include <memory>
#include <optional>
#include <string>

#include "graticule/io/grey_image.hpp"

namespace graticule {

/// Frames of a camera that is plugged in, or of a video, one after another, in grey.
class FrameReader {
 public:
  /// The camera of this number, as the system counts them, at this size if it can; 0: its own.
  /// Throws Error (kInput): no such camera.
  static FrameReader OfCamera(int number, int width = 0, int height = 0);
  /// Throws Error (kInput): no video.
  static FrameReader OfVideo(const std::string& path);

  /// The images of a ROS bag: see BagImages.
  static FrameReader OfBag(const std::string& path, const std::string& topic);

  FrameReader(FrameReader&&) noexcept;
  ~FrameReader();

  /// Waits for the next frame; none at a video's end, or where a camera was unplugged.
  std::optional<GreyImage> Next();
  /// Frames a second, as the file or the driver says; 30 where it does not.
  double Rate() const;

 private:
  class Source;
  class Capture;
  class Bag;
  explicit FrameReader(std::unique_ptr<Source> source);
  std::unique_ptr<Source> source_;
};

}  // namespace graticule
