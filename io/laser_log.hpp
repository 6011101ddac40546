#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// How the beams of a planar laser lie, and where it sits on its robot.
struct LaserGeometry {
  double first_angle = 0;  ///< rad, of the first beam, in the laser's frame: x ahead, y left
  double step = 0;         ///< rad, from one beam to the next
  double max_range = 0;    ///< m; a reading at or above it saw nothing ("no return"); 0: not known
  PlanarPose robot_from_laser;
};

/// One sweep of a planar laser.
struct LaserScan {
  double time = 0;              ///< s, as the log has it
  std::uint32_t robot = 0;      ///< into LaserLog::robots
  std::uint32_t geometry = 0;   ///< into LaserLog::geometries
  PlanarPose odom_from_robot;   ///< dead reckoning when the sweep was taken
  std::size_t first_range = 0;  ///< into LaserLog::ranges
  std::uint32_t beams = 0;
  std::size_t line = 0;  ///< of the file it was read from; 0: none
};

/// Recorded sweeps of one or several robots.  Of each robot, in the order in which they were taken:
/// times rise, but for the jitter of the clock that they were logged with (of intel, 0.9 s).
struct LaserLog {
  std::vector<std::string> robots;  ///< names; key families of their poses
  std::vector<LaserGeometry> geometries;
  std::vector<LaserScan> scans;  ///< in the order of the file
  std::vector<float> ranges;     ///< m, of all sweeps, one after the other

  Span<const float> RangesOf(const LaserScan& scan) const {
    return {ranges.data() + scan.first_range, scan.beams};
  }
  const LaserGeometry& GeometryOf(const LaserScan& scan) const { return geometries[scan.geometry]; }
};

}  // namespace graticule
