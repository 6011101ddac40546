#include "graticule/io/g2o_laser.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/text.hpp"

namespace graticule {
namespace {

bool Same(const LaserGeometry& a, const LaserGeometry& b) {
  // Offsets are differences of printed poses: equal within their last digits.
  constexpr double kPrinted = 1e-5;
  const auto near = [](double x, double y) { return std::abs(x - y) <= kPrinted; };
  return a.first_angle == b.first_angle && a.step == b.step && a.max_range == b.max_range &&
         near(a.robot_from_laser.x, b.robot_from_laser.x) &&
         near(a.robot_from_laser.y, b.robot_from_laser.y) &&
         near(a.robot_from_laser.yaw, b.robot_from_laser.yaw);
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : text_(text), reader_(text, name) {}

  G2oLaser Read() {
    laser_.log.robots = {"robot"};
    while (reader_.NextLine()) {
      const std::string_view word = reader_.Word();
      if (word == "VERTEX_SE2") {
        vertex_ = reader_.Integer("the id of the vertex");
        pose_ = ReadPose("a coordinate of the vertex");
        state_ = State::kVertex;
      } else if (word == "ROBOTLASER1") {
        if (state_ == State::kNone)
          reader_.Fail("expected a VERTEX_SE2 before the first ROBOTLASER1");
        if (state_ == State::kSweep)
          reader_.Fail("expected one ROBOTLASER1 a vertex, found a second of vertex " +
                       std::to_string(vertex_));
        ReadSweep();
        state_ = State::kSweep;
      }
    }
    if (laser_.log.scans.empty()) reader_.FailAt(0, "there is no ROBOTLASER1 line in this file");
    return std::move(laser_);
  }

 private:
  enum class State { kNone, kVertex, kSweep };

  PlanarPose ReadPose(const char* what) {
    PlanarPose pose;
    pose.x = reader_.Double(what);
    pose.y = reader_.Double(what);
    pose.yaw = reader_.Double(what);
    return pose;
  }

  void ReadSweep() {
    const std::size_t place = reader_.WordOffset();
    reader_.Integer("the type of the laser");
    LaserGeometry geometry;
    geometry.first_angle = reader_.Double("the first angle");
    reader_.Double("the field of view");
    geometry.step = reader_.Double("the angle between beams");
    if (!(geometry.step > 0)) reader_.FailExpected("a step above 0", "the angle between beams");
    geometry.max_range = reader_.Double("the maximum range");
    if (!(geometry.max_range > 0)) reader_.FailExpected("a range above 0", "the maximum range");
    reader_.Double("the accuracy");
    reader_.Integer("the remission mode");

    LaserScan scan;
    scan.first_range = laser_.log.ranges.size();
    const std::uint64_t beams = reader_.Integer("the number of beams");
    for (std::uint64_t i = 0; i < beams; ++i)
      laser_.log.ranges.push_back(static_cast<float>(reader_.Double("a range")));
    scan.beams = static_cast<std::uint32_t>(beams);
    const std::uint64_t remissions = reader_.Integer("the number of remissions");
    for (std::uint64_t i = 0; i < remissions; ++i) reader_.Double("a remission");
    const PlanarPose odom_from_laser = ReadPose("a coordinate of the laser");
    scan.odom_from_robot = ReadPose("a coordinate of the robot");
    for (int i = 0; i < 5; ++i) reader_.Double("a speed or a safety distance");
    scan.time = reader_.Double("the time");
    reader_.Word("the host's name");
    reader_.Double("the logger's time");
    reader_.ExpectEnd();
    // Counted from sweep to sweep: from the beginning it would be quadratic.
    line_ += static_cast<std::size_t>(
        std::count(text_.begin() + static_cast<std::ptrdiff_t>(counted_),
                   text_.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
    counted_ = place;
    scan.line = line_;

    geometry.robot_from_laser = Inverse(scan.odom_from_robot) * odom_from_laser;
    std::vector<LaserGeometry>& known = laser_.log.geometries;
    while (scan.geometry < known.size() && !Same(known[scan.geometry], geometry)) ++scan.geometry;
    if (scan.geometry == known.size()) known.push_back(geometry);
    laser_.log.scans.push_back(scan);
    laser_.vertices.push_back(vertex_);
    laser_.world_from_robot.push_back(pose_);
  }

  std::string_view text_;
  TextReader reader_;
  G2oLaser laser_;
  State state_ = State::kNone;
  std::uint64_t vertex_ = 0;
  PlanarPose pose_;
  std::size_t line_ = 1, counted_ = 0;  // the line at an offset
};

}  // namespace

G2oLaser ParseG2oLaser(std::string_view text, const std::string& name) {
  return Reader(text, name).Read();
}

}  // namespace graticule
