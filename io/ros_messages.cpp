#include "graticule/io/ros_messages.hpp"

#include <cmath>
#include <cstring>
#include <map>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

class Bytes {
 public:
  Bytes(std::string_view data, const char* type) : left_(data), type_(type) {}

  std::string_view Take(std::size_t size) {
    if (size > left_.size()) throw Error(std::string("a ") + type_ + " that is cut short");
    const std::string_view taken = left_.substr(0, size);
    left_.remove_prefix(size);
    return taken;
  }
  template <class Number>
  Number Get() {
    static_assert(sizeof(Number) <= 8, "plain numbers");
    Number number;
    std::memcpy(&number, Take(sizeof number).data(), sizeof number);
    return number;
  }
  std::string_view Text() { return Take(Get<std::uint32_t>()); }
  /// How many elements of so many bytes follow.
  std::size_t Count(std::size_t size) {
    const auto count = Get<std::uint32_t>();
    if (count > left_.size() / size) Take(left_.size() + 1);
    return count;
  }
  std::string Frame() {
    std::string_view name = Text();
    if (!name.empty() && name.front() == '/') name.remove_prefix(1);
    return std::string(name);
  }
  RosHeader Header() {
    Get<std::uint32_t>();  // a running number
    const auto seconds = Get<std::uint32_t>(), nanoseconds = Get<std::uint32_t>();
    return {seconds + 1e-9 * nanoseconds, Frame()};
  }
  std::array<double, 7> Pose() {
    std::array<double, 7> pose;
    for (double& number : pose) {
      number = Get<double>();
      if (!std::isfinite(number))
        throw Error(std::string("a ") + type_ + " with a pose that is not finite");
    }
    const double length =
        std::sqrt(pose[3] * pose[3] + pose[4] * pose[4] + pose[5] * pose[5] + pose[6] * pose[6]);
    if (!(std::abs(length - 1) < 0.1))
      throw Error(std::string("a ") + type_ + " with a quaternion whose length is not 1");
    for (std::size_t i = 3; i < 7; ++i) pose[i] /= length;
    return pose;
  }

 private:
  std::string_view left_;
  const char* type_;
};

struct Encoding {
  std::size_t bytes;              // a pixel
  std::array<std::size_t, 3> at;  // of red, green and blue in it; alike: a shade
  bool is_deep = false;           // 16 bits
};

const std::map<std::string, Encoding>& Encodings() {
  static const std::map<std::string, Encoding> encodings = {
      {"mono8", {1, {0, 0, 0}}},        {"8UC1", {1, {0, 0, 0}}},
      {"mono16", {2, {0, 0, 0}, true}}, {"16UC1", {2, {0, 0, 0}, true}},
      {"rgb8", {3, {0, 1, 2}}},         {"bgr8", {3, {2, 1, 0}}},
      {"8UC3", {3, {2, 1, 0}}},         {"rgba8", {4, {0, 1, 2}}},
      {"bgra8", {4, {2, 1, 0}}},        {"yuv422", {2, {1, 1, 1}}},
      {"yuv422_yuy2", {2, {0, 0, 0}}}};
  return encodings;
}

}  // namespace

RosLaserScan ParseRosLaserScan(std::string_view data) {
  Bytes bytes(data, "sensor_msgs/LaserScan");
  RosLaserScan scan;
  scan.header = bytes.Header();
  scan.angle_min = bytes.Get<float>();
  bytes.Get<float>();  // angle_max
  scan.angle_increment = bytes.Get<float>();
  bytes.Get<float>();  // time_increment
  bytes.Get<float>();  // scan_time
  scan.range_min = bytes.Get<float>();
  scan.range_max = bytes.Get<float>();
  for (std::size_t i = bytes.Count(sizeof(float)); i > 0; --i)
    scan.ranges.push_back(bytes.Get<float>());
  const bool is_fine = std::isfinite(scan.angle_min) && std::isfinite(scan.angle_increment) &&
                       scan.angle_increment != 0 && std::isfinite(scan.range_max) &&
                       scan.range_max > 0 && std::isfinite(scan.range_min);
  if (!is_fine)
    throw Error("a sensor_msgs/LaserScan whose angles or limits of range make no sense");
  return scan;
}

RosTransform ParseRosOdometry(std::string_view data) {
  Bytes bytes(data, "nav_msgs/Odometry");
  RosTransform odometry;
  odometry.header = bytes.Header();
  odometry.child = bytes.Frame();
  odometry.parent_from_child = bytes.Pose();
  return odometry;
}

std::vector<RosTransform> ParseRosTransforms(std::string_view data) {
  Bytes bytes(data, "tf2_msgs/TFMessage");
  std::vector<RosTransform> transforms;
  for (std::size_t i = bytes.Count(12); i > 0; --i) {
    RosTransform transform;
    transform.header = bytes.Header();
    transform.child = bytes.Frame();
    transform.parent_from_child = bytes.Pose();
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

RosImage ParseRosImage(std::string_view data) {
  Bytes bytes(data, "sensor_msgs/Image");
  RosImage image;
  image.header = bytes.Header();
  image.height = bytes.Get<std::uint32_t>();
  image.width = bytes.Get<std::uint32_t>();
  image.encoding = std::string(bytes.Text());
  image.is_big_endian = bytes.Get<std::uint8_t>() != 0;
  image.step = bytes.Get<std::uint32_t>();
  image.data = bytes.Text();
  return image;
}

RosImage ParseRosCompressedImage(std::string_view data) {
  Bytes bytes(data, "sensor_msgs/CompressedImage");
  RosImage image;
  image.header = bytes.Header();
  image.encoding = std::string(bytes.Text());
  image.data = bytes.Text();
  return image;
}

GreyImage GreyOf(const RosImage& image) {
  const auto found = Encodings().find(image.encoding);
  if (found == Encodings().end()) {
    std::string list;
    for (const auto& [name, encoding] : Encodings()) list += (list.empty() ? "" : ", ") + name;
    throw Error("images of encoding " + Quoted(image.encoding) + "; expected one of " + list);
  }
  const Encoding& encoding = found->second;
  const std::uint64_t row = static_cast<std::uint64_t>(image.width) * encoding.bytes;
  if (image.width == 0 || image.height == 0 || row > image.step ||
      static_cast<std::uint64_t>(image.step) * (image.height - 1) + row > image.data.size())
    throw Error("a sensor_msgs/Image with fewer bytes than its size asks for");
  GreyImage grey;
  grey.width = image.width;
  grey.height = image.height;
  grey.shades.reserve(grey.width * grey.height);
  for (std::size_t y = 0; y < grey.height; ++y)
    for (std::size_t x = 0; x < grey.width; ++x) {
      const auto* pixel = reinterpret_cast<const unsigned char*>(image.data.data()) +
                          y * image.step + x * encoding.bytes;
      if (encoding.is_deep) {  // the upper eight bits
        grey.shades.push_back(pixel[image.is_big_endian ? 0 : 1]);
        continue;
      }
      const auto [r, g, b] = encoding.at;
      // The weights of ITU-R BT.601, as OpenCV has them.
      grey.shades.push_back(r == g ? pixel[r]
                                   : static_cast<std::uint8_t>(std::lround(
                                         0.299 * pixel[r] + 0.587 * pixel[g] + 0.114 * pixel[b])));
    }
  return grey;
}

}  // namespace graticule
