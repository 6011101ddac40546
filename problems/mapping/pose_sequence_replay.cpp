#include "graticule/problems/mapping/pose_sequence_replay.hpp"

#include <set>

#include "graticule/solver/error.hpp"

namespace graticule {

Mission CutIntoRobots(Mission mission, const PoseSequence& sequence, const std::string& name) {
  if (mission.log.scans.size() != sequence.nodes)
    throw Error(name + ": this sequence has " + std::to_string(sequence.nodes) +
                " nodes, but there are scans of " + std::to_string(mission.log.scans.size()));
  mission.log.robots.clear();
  for (std::uint32_t robot = 1; robot <= sequence.robots; ++robot)
    mission.log.robots.push_back("robot" + std::to_string(robot));
  for (std::uint32_t i = 0; i < sequence.nodes; ++i)
    mission.log.scans[i].robot = sequence.RobotOf(i);
  std::vector<MissionNode> nodes;
  std::vector<char> has_come(sequence.nodes, 0);
  for (const PoseSequence::Pose& pose : sequence.poses) {
    if (has_come[pose.node]) continue;
    has_come[pose.node] = 1;
    nodes.push_back(mission.nodes[pose.node]);
  }
  mission.nodes = std::move(nodes);
  return mission;
}

PoseSequenceReplay::PoseSequenceReplay(const Mission& mission, const PoseSequence& sequence,
                                       double every_s)
    : mission_(mission), sequence_(sequence), every_s_(every_s) {
  node_of_.assign(sequence.nodes, mission.nodes.size());
  for (std::size_t i = 0; i < mission.nodes.size(); ++i) node_of_[mission.nodes[i].scan] = i;
}

bool PoseSequenceReplay::Next(MissionStep* step) {
  if (graph_ == sequence_.GraphCount()) return false;
  for (const PoseSequence::Pose& pose : sequence_.Graph(graph_)) {
    const std::size_t node = node_of_[pose.node];
    if (node == poses_.size()) poses_.emplace_back();
    poses_[node] = pose.world_from_robot;
  }
  ++graph_;
  step->time = every_s_ * static_cast<double>(graph_);
  step->nodes = poses_.size();
  step->world_from_robot = poses_;
  return true;
}

Graph PoseSequenceReplay::Problem() const {
  std::set<Key> keys;
  for (std::size_t i = 0; i < poses_.size(); ++i)
    keys.insert(mission_.graph.KeyOf(mission_.nodes[i].variable));
  Graph graph = mission_.graph.Slice(keys);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const std::vector<double> value = {poses_[i].x, poses_[i].y, poses_[i].yaw};
    graph.SetValue(graph.IdOf(mission_.graph.KeyOf(mission_.nodes[i].variable)), value);
  }
  return graph;
}

}  // namespace graticule
