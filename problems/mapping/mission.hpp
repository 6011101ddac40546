#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "graticule/io/g2o_laser.hpp"
#include "graticule/io/geography.hpp"
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
  /// Where each robot begins, in the graph's world, where that was known before; else empty.
  std::vector<PlanarPose> starts = {};
  /// Of the graph's world: x east and y north of here.  Empty: it lies anyhow.
  std::optional<Geodetic> datum = {};

  double TimeOf(const MissionNode& node) const { return log.scans[node.scan].time; }
};

/// The mission of a g2o file that has scans after its vertices: the graph as it was read, keys
/// `pose:ID`.  Throws Error (input): a scan of a pose that the graph does not have.
Mission MissionFromG2o(Graph graph, G2oLaser laser, const std::string& name);

}  // namespace graticule
