#pragma once

#include <rosbag/bag.h>

#include <cstring>
#include <string>
#include <vector>

namespace graticule::test {

/// A message as its bytes, for ROS' own writer of bags.
struct RawMessage {
  std::string type, bytes;
};

/// Bytes as ROS serialises them.
class RosBytes {
 public:
  template <class Number>
  RosBytes& Add(Number number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    text_.append(bytes, sizeof number);
    return *this;
  }
  RosBytes& Text(const std::string& text) {
    Add(static_cast<std::uint32_t>(text.size()));
    text_ += text;
    return *this;
  }
  RosBytes& Header(double stamp_s, const std::string& frame) {
    const auto seconds = static_cast<std::uint32_t>(stamp_s);
    Add(std::uint32_t{0}).Add(seconds);
    return Add(static_cast<std::uint32_t>(std::lround((stamp_s - seconds) * 1e9))).Text(frame);
  }
  /// A pose of the plane; `roll` of half a turn is upside down.
  RosBytes& Pose(double x, double y, double yaw, bool is_upside_down = false) {
    const double c = std::cos(yaw / 2), s = std::sin(yaw / 2);
    Add(x).Add(y).Add(0.0);
    if (is_upside_down) return Add(c).Add(s).Add(0.0).Add(0.0);
    return Add(0.0).Add(0.0).Add(s).Add(c);
  }
  const std::string& Whole() const { return text_; }

 private:
  std::string text_;
};

}  // namespace graticule::test

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<graticule::test::RawMessage> {
  static const char* value(const graticule::test::RawMessage&) {
    return "00000000000000000000000000000000";
  }
};
template <>
struct DataType<graticule::test::RawMessage> {
  static const char* value(const graticule::test::RawMessage& message) {
    return message.type.c_str();
  }
};
template <>
struct Definition<graticule::test::RawMessage> {
  static const char* value(const graticule::test::RawMessage&) { return ""; }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<graticule::test::RawMessage> {
  template <class Stream>
  static void write(Stream& stream, const graticule::test::RawMessage& message) {
    std::memcpy(stream.advance(static_cast<std::uint32_t>(message.bytes.size())),
                message.bytes.data(), message.bytes.size());
  }
  static std::uint32_t serializedLength(const graticule::test::RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros
