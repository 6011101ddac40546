#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/grey_image.hpp"

namespace graticule {

// Messages of ROS 1 as they are serialised (little-endian, lists and texts with their length before
// them).  Each throws Error where the bytes are not such a message: "a sensor_msgs/LaserScan that
// is cut short".

struct RosHeader {
  double stamp_s = 0;
  std::string frame;  ///< without a leading slash
};

/// sensor_msgs/LaserScan.
struct RosLaserScan {
  RosHeader header;
  double angle_min = 0, angle_increment = 0;  ///< rad
  double range_min = 0, range_max = 0;        ///< m
  std::vector<float> ranges;
};
RosLaserScan ParseRosLaserScan(std::string_view data);

/// Where a frame is in another: x y z [m] qx qy qz qw.
struct RosTransform {
  RosHeader header;   ///< the parent's frame
  std::string child;  ///< its frame, without a leading slash
  std::array<double, 7> parent_from_child = {0, 0, 0, 0, 0, 0, 1};
};
/// nav_msgs/Odometry: its pose.
RosTransform ParseRosOdometry(std::string_view data);
/// tf2_msgs/TFMessage and tf/tfMessage.
std::vector<RosTransform> ParseRosTransforms(std::string_view data);

/// sensor_msgs/Image and CompressedImage.
struct RosImage {
  RosHeader header;
  std::uint32_t width = 0, height = 0, step = 0;  ///< 0 of a compressed one
  std::string encoding;                           ///< "mono8", of a compressed one its format
  bool is_big_endian = false;
  std::string_view data;  ///< into the message
};
RosImage ParseRosImage(std::string_view data);
RosImage ParseRosCompressedImage(std::string_view data);

/// A sensor_msgs/Image in grey.  Throws Error: an encoding other than mono8, mono16, rgb8, bgr8,
/// rgba8, bgra8, 8UC1, 8UC3, 16UC1, yuv422 and yuv422_yuy2; fewer bytes than its size asks for.
GreyImage GreyOf(const RosImage& image);

}  // namespace graticule
