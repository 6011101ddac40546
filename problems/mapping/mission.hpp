#pragma once

#include <cstddef>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// A pose of a robot, and the scan that was taken there.
struct MissionNode {
  VariableId variable = 0;  ///< se2/1
  std::size_t scan = 0;     ///< into LaserLog::scans
};

/// What a team of robots saw, and the pose graph that says where it was.
struct Mission {
  LaserLog log;
  Graph graph;
  std::vector<MissionNode> nodes;  ///< in the order in which they came

  double TimeOf(const MissionNode& node) const { return log.scans[node.scan].time; }
};

}  // namespace graticule
