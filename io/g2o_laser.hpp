#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/laser_log.hpp"

namespace graticule {

/// The sweeps of a g2o file, and where the file's vertices say they were taken.
struct G2oLaser {
  LaserLog log;                              ///< one robot, "robot"
  std::vector<std::uint64_t> vertices;       ///< of each scan: the id in the file
  std::vector<PlanarPose> world_from_robot;  ///< of each scan: the vertex' value
};

/// Reads the ROBOTLASER1 lines that follow a VERTEX_SE2 each, as CARMEN has them: `ROBOTLASER1 type
/// start fov step maxrange accuracy remission n r1..rn m i1..im laser_x laser_y laser_yaw robot_x
/// robot_y robot_yaw tv rv forward side turn_axis time host logger_time`.  Other lines are passed
/// over.  Throws Error "name:line:column: ...": a malformed line, a sweep before any vertex, a
/// second sweep of one, no sweep at all.
G2oLaser ParseG2oLaser(std::string_view text, const std::string& name);

}  // namespace graticule
