#include "graticule/io/robot_laser.hpp"

#include <charconv>
#include <cmath>

#include "graticule/io/text.hpp"

namespace graticule {
namespace {

// The shortest text that reads back as the same float by way of a double, as readers do.
void AppendRange(float range, std::string* text) {
  if (!std::isfinite(range)) range = 0;
  char digits[32];
  const char* const end = std::to_chars(digits, digits + sizeof(digits), range).ptr;
  double back = 0;
  std::from_chars(digits, end, back);
  if (static_cast<float>(back) == range)
    text->append(digits, static_cast<std::size_t>(end - digits));
  else
    AppendNumber(text, static_cast<double>(range));
}

}  // namespace

void AppendRobotLaser(const LaserLog& log, const LaserScan& scan, std::string* text) {
  const auto number = [text](double value) {
    *text += ' ';
    AppendNumber(text, value);
  };
  const auto pose = [&number](const PlanarPose& frame) {
    for (const double value : {frame.x, frame.y, frame.yaw}) number(value);
  };
  const LaserGeometry& geometry = log.GeometryOf(scan);
  *text += "ROBOTLASER1 0";
  number(geometry.first_angle);
  number(geometry.step * scan.beams);
  number(geometry.step);
  number(geometry.max_range);
  *text += " 0 0 ";
  AppendInteger(text, scan.beams);
  for (const float range : log.RangesOf(scan)) {
    *text += ' ';
    AppendRange(range, text);
  }
  *text += " 0";
  pose(scan.odom_from_robot * geometry.robot_from_laser);
  pose(scan.odom_from_robot);
  *text += " 0 0 0 0 0";
  number(scan.time);
  *text += " graticule";
  number(scan.time);
  *text += '\n';
}

}  // namespace graticule
