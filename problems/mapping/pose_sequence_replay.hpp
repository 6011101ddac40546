#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "graticule/io/pose_sequence.hpp"
#include "graticule/problems/mapping/graph_sequence.hpp"
#include "graticule/problems/mapping/mission.hpp"

namespace graticule {

/// Cuts the mission of one robot into those that a sequence of its graphs names, `robot1` ..: scan
/// i is the sequence's node i.  Nodes are in the order in which they come.  Throws Error (input,
/// with the name): other numbers of nodes.
Mission CutIntoRobots(Mission mission, const PoseSequence& sequence, const std::string& name);

/// The graphs of a sequence, poses as it has them, factors of the mission as far as their nodes
/// have come.  A sequence says no times: graph g is at g times `every_s`.
class PoseSequenceReplay : public GraphSequence {
 public:
  /// The mission, of CutIntoRobots, and the sequence must outlive it.
  PoseSequenceReplay(const Mission& mission, const PoseSequence& sequence, double every_s);

  bool Next(MissionStep* step) override;
  Graph Problem() const override;

 private:
  const Mission& mission_;
  const PoseSequence& sequence_;
  double every_s_;
  std::vector<std::size_t> node_of_;  // by the sequence's node
  std::vector<PlanarPose> poses_;     // of the nodes so far
  std::size_t graph_ = 0;
};

}  // namespace graticule
