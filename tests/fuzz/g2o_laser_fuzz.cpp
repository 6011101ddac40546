#include "fuzz.hpp"
#include "graticule/io/g2o_laser.hpp"
#include "graticule/io/robot_laser.hpp"

// Its sweeps are written, and read again as many.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  const G2oLaser laser = ParseG2oLaser(text, "fuzz.g2o");
  std::string written;
  for (const LaserScan& scan : laser.log.scans) {
    if (scan.geometry >= laser.log.geometries.size()) std::abort();
    if (scan.first_range + scan.beams > laser.log.ranges.size()) std::abort();
    written += "VERTEX_SE2 1 0 0 0\n";
    AppendRobotLaser(laser.log, scan, &written);
  }
  const G2oLaser again = ParseG2oLaser(written, "again.g2o");
  if (again.log.ranges.size() != laser.log.ranges.size()) std::abort();
}
