#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "graticule/io/bag.hpp"
#include "graticule/io/grey_image.hpp"

namespace graticule {

/// The images of one topic of a ROS bag, sensor_msgs/Image or CompressedImage, in grey, one after
/// another.
class BagImages {
 public:
  /// `topic`: empty means the only one with images.  Throws Error "path: ...": as BagReader and
  /// TopicOf do, no images.
  BagImages(const std::string& path, const std::string& topic);

  /// Throws Error "path: topic: ...": a message that is damaged, an encoding that is not read.
  std::optional<GreyImage> Next();
  /// Goes on to the next without looking at this one; false at the end.
  bool Skip();

  std::size_t Count() const { return count_; }
  const std::string& Topic() const { return topic_; }
  /// Images a second, by when they were recorded; 30 where that does not say.
  double Rate() const { return rate_; }

 private:
  bool Find(BagMessage* message);

  std::string topic_;
  std::size_t count_ = 0;
  double rate_ = 30;
  BagReader reader_;
};

}  // namespace graticule
