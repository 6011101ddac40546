#include "graticule/io/sweep.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "graticule/io/comma_separated.hpp"
#include "graticule/io/text.hpp"

namespace graticule {
namespace {

constexpr double kFarthest = 1e6;   // m
constexpr double kMostAngle = 1e3;  // rad: a servo may have turned often

double Angle(TextReader* reader, const char* what) {
  const double angle = reader->Double(what);
  if (std::abs(angle) > kMostAngle) reader->Fail("expected an angle within 1000 rad");
  return angle;
}

float Range(TextReader* reader) {
  for (const char* word : {"nan", "NaN", "inf"})
    if (reader->Accept(word)) return std::nanf("");
  const double range = reader->Double("a range");
  if (!(range >= 0 && range <= kFarthest)) reader->Fail("expected a range from 0 to 1e6 m");
  const auto rounded = static_cast<float>(range);
  return rounded > 0 ? rounded : std::nanf("");
}

void ReadAxis(TextReader* reader, Sweep* sweep) {
  double squared = 0;
  for (double& value : sweep->axis) {
    value = reader->Double("the servo's axis");
    squared += value * value;
  }
  if (!(std::abs(squared - 1) < 1e-6)) reader->Fail("expected an axis of length 1");
}

void ReadMount(TextReader* reader, Sweep* sweep) {
  double squared = 0;
  for (std::size_t i = 0; i < 7; ++i) {
    const double value = sweep->servo_from_laser[i] = reader->Double("servo_from_laser");
    if (std::abs(value) > kFarthest) reader->Fail("expected a place within 1e6 m");
    if (i >= 3) squared += value * value;
  }
  if (!(std::abs(squared - 1) < 1e-6)) reader->Fail("expected a unit quaternion (qx qy qz qw)");
}

}  // namespace

Sweep ParseSweep(std::string_view original, const std::string& name) {
  const std::string text = CommasAsBlanks(original, name);
  TextReader reader(text, name);
  if (text.empty()) reader.FailAt(0, "the file is empty");
  Sweep sweep;
  while (reader.NextLine()) {
    const std::size_t line = reader.Offset();
    const std::string_view first = reader.Word();
    if (first[0] == '#' || first.substr(0, 5) == "stamp") continue;
    if (first == "axis" || first == "servo_from_laser") {
      if (!sweep.scans.empty()) reader.Fail("expected this line before the scans");
      first == "axis" ? ReadAxis(&reader, &sweep) : ReadMount(&reader, &sweep);
      reader.ExpectEnd();
      continue;
    }
    reader.Seek(line);
    SweptScan scan;
    scan.stamp_s = reader.Double("the stamp");
    if (!sweep.scans.empty() && scan.stamp_s < sweep.scans.back().stamp_s)
      reader.Fail("expected a stamp not before the last scan's");
    scan.servo_rad = Angle(&reader, "the servo's angle");
    scan.first_bearing_rad = Angle(&reader, "the first bearing");
    scan.bearing_step_rad = Angle(&reader, "the step of the bearing");
    if (!sweep.scans.empty()) scan.ranges_m.reserve(sweep.scans[0].ranges_m.size());
    while (!reader.AtLineEnd()) scan.ranges_m.push_back(Range(&reader));
    const std::size_t expected =
        sweep.scans.empty() ? scan.ranges_m.size() : sweep.scans[0].ranges_m.size();
    if (scan.ranges_m.empty()) reader.Fail("expected at least one range");
    if (scan.ranges_m.size() != expected)
      reader.Fail("expected " + std::to_string(expected) +
                  " ranges as in the scans before, found " + std::to_string(scan.ranges_m.size()));
    sweep.scans.push_back(std::move(scan));
  }
  if (sweep.scans.empty()) reader.FailAt(0, "there is no scan");
  if (text.back() != '\n')
    reader.FailAt(text.size(), "expected the end of the line: the file may be cut short");
  return sweep;
}

std::string FormatSweep(const Sweep& sweep) {
  std::string text = "axis";
  const auto append = [&](double number) {
    text += ',';
    AppendNumber(&text, number);
  };
  for (const double value : sweep.axis) append(value);
  text += "\nservo_from_laser";
  for (const double value : sweep.servo_from_laser) append(value);
  text += "\nstamp_s,servo_rad,first_bearing_rad,bearing_step_rad,range_m...\n";
  for (const SweptScan& scan : sweep.scans) {
    AppendNumber(&text, scan.stamp_s);
    for (const double value : {scan.servo_rad, scan.first_bearing_rad, scan.bearing_step_rad})
      append(value);
    for (const float range : scan.ranges_m) {
      if (std::isfinite(range)) {
        append(range);
      } else {
        text += ",nan";
      }
    }
    text += '\n';
  }
  return text;
}

PointCloud ToCloud(const Sweep& sweep) {
  const auto& mount = sweep.servo_from_laser;
  Eigen::Isometry3d servo_from_laser =
      Eigen::Translation3d(mount[0], mount[1], mount[2]) *
      Eigen::Quaterniond(mount[6], mount[3], mount[4], mount[5]).normalized();
  const Eigen::Vector3d axis(sweep.axis.data());
  PointCloud cloud;
  cloud.height = sweep.scans.size();
  cloud.width = sweep.scans.empty() ? 0 : sweep.scans[0].ranges_m.size();
  cloud.in_sensor.reserve(cloud.width * cloud.height);
  for (const SweptScan& scan : sweep.scans) {
    const Eigen::Isometry3d sensor_from_laser =
        Eigen::AngleAxisd(scan.servo_rad, axis.normalized()) * servo_from_laser;
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double range = scan.ranges_m[i];
      const double bearing =
          scan.first_bearing_rad + static_cast<double>(i) * scan.bearing_step_rad;
      const Eigen::Vector3d in_laser(range * std::cos(bearing), range * std::sin(bearing), 0);
      cloud.in_sensor.push_back(std::isfinite(range)
                                    ? Eigen::Vector3f((sensor_from_laser * in_laser).cast<float>())
                                    : kNoReturn);
    }
  }
  return cloud;
}

}  // namespace graticule
