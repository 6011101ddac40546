#pragma once

#include <string>

#include "graticule/io/laser_log.hpp"

namespace graticule {

/// Appends a scan as CARMEN's ROBOTLASER1 line, which logs and g2o files have (G2oLaser says what
/// is in it).  Ranges, times and poses read back to the bit; what is not finite among the ranges is
/// written as 0, which says as little.
void AppendRobotLaser(const LaserLog& log, const LaserScan& scan, std::string* text);

}  // namespace graticule
