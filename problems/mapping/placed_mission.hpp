#pragma once

#include "graticule/problems/mapping/mission.hpp"

namespace graticule {

/// A mission whose log says already where its robots were: somebody has corrected its poses, and
/// they are to be kept.  A node wherever a robot has gone or turned this far; se2/1 "robot:N" where
/// the log has it, joined by between_se2/1 of the source "log" that agree with it, the first of
/// each robot fixed.  Nodes are in the order of time.  Throws Error (kUsage): a distance or turn
/// that is not above 0.
Mission MissionAsPlaced(LaserLog log, const Registry& types, double node_distance_m = 0.2,
                        double node_turn_rad = 0.2);

}  // namespace graticule
