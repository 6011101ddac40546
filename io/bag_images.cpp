#include "graticule/io/bag_images.hpp"

#include "graticule/io/photo.hpp"
#include "graticule/io/ros_messages.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr char kImage[] = "sensor_msgs/Image", kCompressed[] = "sensor_msgs/CompressedImage";

}  // namespace

BagImages::BagImages(const std::string& path, const std::string& topic) : reader_(path) {
  const std::vector<BagConnection> topics = BagTopics(path);
  topic_ = TopicOf(path, topics, {kImage, kCompressed}, topic, "", "--image-topic");
  if (topic_.empty()) throw Error(path + ": has no images (" + kImage + ")" + ListOf(topics));
  BagMessage message;
  double first = 0, last = 0;
  while (Find(&message)) {
    if (count_++ == 0) first = message.stamp_s;
    last = message.stamp_s;
  }
  if (count_ > 1 && last > first) rate_ = static_cast<double>(count_ - 1) / (last - first);
  reader_ = BagReader(path);
}

bool BagImages::Find(BagMessage* message) {
  while (reader_.Next(message))
    if (reader_.Connections()[message->connection].topic == topic_) return true;
  return false;
}

bool BagImages::Skip() {
  BagMessage message;
  return Find(&message);
}

std::optional<GreyImage> BagImages::Next() {
  BagMessage message;
  if (!Find(&message)) return std::nullopt;
  const std::string about = reader_.Path() + ": " + topic_;
  const bool is_compressed =
      reader_.Connections()[message.connection].type == std::string_view(kCompressed);
  if (is_compressed) {
    std::string_view picture;
    try {
      picture = ParseRosCompressedImage(message.data).data;
    } catch (const Error& error) {
      throw Error(about + ": " + error.what());
    }
    return ParseGreyPhoto(picture, about);
  }
  try {
    return GreyOf(ParseRosImage(message.data));
  } catch (const Error& error) {
    throw Error(about + ": " + error.what());
  }
}

}  // namespace graticule
