#include "graticule/problems/mapping/recorded_mission.hpp"

#include <algorithm>
#include <unordered_map>

#include "graticule/io/robot_laser.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {
namespace {

std::string IndexName(const std::string& folder) { return folder + "/mission.index"; }

}  // namespace

MissionIndex IndexOf(const Mission& mission) {
  MissionIndex index;
  index.datum = mission.datum;
  index.lasers = mission.log.geometries;
  constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);
  std::vector<std::string> families(mission.log.robots.size());
  for (const MissionNode& node : mission.nodes) {
    std::string& family = families[mission.log.scans[node.scan].robot];
    const std::string_view own = mission.graph.KeyOf(node.variable).Family();
    if (family.empty()) family = own;
    if (family != own)
      throw Error("the nodes of a robot are named " + family + " and " + std::string(own) +
                      ": such a mission cannot be recorded",
                  ErrorKind::kOther);
  }
  std::vector<std::uint32_t> position(families.size(), kNone);
  for (std::size_t robot = 0; robot < families.size(); ++robot) {
    if (families[robot].empty()) continue;
    const std::string& name = mission.log.robots[robot];
    position[robot] = static_cast<std::uint32_t>(index.robots.size());
    index.robots.push_back({name, families[robot], "scans/" + name + ".g2o.gz", {}, 0});
    if (!mission.starts.empty()) index.robots.back().start = mission.starts[robot];
  }
  for (const MissionNode& node : mission.nodes) {
    const LaserScan& scan = mission.log.scans[node.scan];
    index.nodes.push_back(
        {mission.graph.KeyOf(node.variable), position[scan.robot], scan.geometry, 0});
  }
  return index;
}

std::string FormatScans(const Mission& mission, std::uint32_t robot,
                        const std::vector<PlanarPose>& world_from_robot) {
  std::string text;
  for (std::size_t i = 0; i < mission.nodes.size(); ++i) {
    const LaserScan& scan = mission.log.scans[mission.nodes[i].scan];
    if (scan.robot != robot) continue;
    text += "VERTEX_SE2 " + std::to_string(mission.graph.KeyOf(mission.nodes[i].variable).Number());
    // What a mission that was stopped has not reached is at its odometry.
    const PlanarPose& pose =
        i < world_from_robot.size() ? world_from_robot[i] : scan.odom_from_robot;
    for (const double number : {pose.x, pose.y, pose.yaw}) {
      text += ' ';
      AppendNumber(&text, number);
    }
    text += '\n';
    AppendRobotLaser(mission.log, scan, &text);
  }
  return text;
}

void HoldEachPiece(Graph* graph) {
  const std::size_t count = graph->VariableCount();
  UnionFind pieces(count);
  for (FactorId id = 0; id < graph->FactorCount(); ++id)
    for (const VariableId variable : graph->VariablesOf(id))
      pieces.Join(variable, graph->VariablesOf(id)[0]);
  std::vector<char> is_held(count, 0);
  for (VariableId id = 0; id < count; ++id)
    if (graph->IsFixed(id)) is_held[pieces.Root(id)] = 1;
  for (FactorId id = 0; id < graph->FactorCount(); ++id)
    if (!graph->FactorAt(id).type->IsRelative())
      is_held[pieces.Root(graph->VariablesOf(id)[0])] = 1;
  for (VariableId id = 0; id < count; ++id) {
    char& held = is_held[pieces.Root(id)];
    if (!held) graph->SetFixed(id, true);
    held = 1;
  }
}

Mission MissionFromParts(const MissionIndex& index, std::vector<G2oLaser> scans, Graph graph,
                         const std::string& folder) {
  Mission mission{{}, std::move(graph), {}};
  mission.datum = index.datum;
  mission.log.geometries = index.lasers;
  std::unordered_map<Key, std::size_t, KeyHash> node_of;
  for (std::size_t i = 0; i < index.nodes.size(); ++i) node_of.emplace(index.nodes[i].key, i);
  mission.nodes.resize(index.nodes.size());
  std::vector<char> has_scan(index.nodes.size(), 0);
  bool all_start = true;
  for (std::uint32_t robot = 0; robot < index.robots.size(); ++robot) {
    const MissionIndex::Robot& about = index.robots[robot];
    const std::string file = folder + "/" + about.scans;
    mission.log.robots.push_back(about.name);
    mission.starts.push_back(about.start.value_or(PlanarPose{}));
    all_start &= about.start.has_value();
    G2oLaser& laser = scans[robot];
    for (std::size_t i = 0; i < laser.log.scans.size(); ++i) {
      LaserScan scan = laser.log.scans[i];
      const Key key(about.family, laser.vertices[i]);
      const auto found = node_of.find(key);
      if (found == node_of.end() || index.nodes[found->second].robot != robot)
        throw Error(file, scan.line, 1,
                    "expected a scan of a node of " + about.name + ", found one of " +
                        key.ToString() + ", which " + IndexName(folder) + " does not have");
      const std::size_t node = found->second;
      if (has_scan[node])
        throw Error(file, scan.line, 1,
                    "expected one scan a node, found a second of " + key.ToString());
      has_scan[node] = 1;
      scan.robot = robot;
      scan.geometry = index.nodes[node].laser;
      scan.first_range += mission.log.ranges.size();
      mission.nodes[node].scan = mission.log.scans.size();
      mission.log.scans.push_back(scan);
    }
    mission.log.ranges.insert(mission.log.ranges.end(), laser.log.ranges.begin(),
                              laser.log.ranges.end());
    laser = {};
  }
  if (!all_start) mission.starts.clear();
  for (std::size_t i = 0; i < index.nodes.size(); ++i) {
    const MissionIndex::Node& node = index.nodes[i];
    if (!has_scan[i])
      throw Error(
          IndexName(folder), node.line, 1,
          "there is no scan of " + node.key.ToString() + " in " + index.robots[node.robot].scans);
    mission.nodes[i].variable = mission.graph.Find(node.key);
  }
  // Nodes beyond the last graph, of a recording that was stopped, are of no use.
  mission.nodes.resize(index.graphs.back().nodes);
  (void)PosesOf(index, index.graphs.back(), mission.graph, folder);
  return mission;
}

std::vector<PlanarPose> PosesOf(const MissionIndex& index, const MissionIndex::Graph& step,
                                const Graph& graph, const std::string& folder) {
  std::vector<PlanarPose> poses;
  poses.reserve(step.nodes);
  for (std::size_t i = 0; i < step.nodes; ++i) {
    const Key& key = index.nodes[i].key;
    const VariableId variable = graph.Find(key);
    if (variable == Layout::kNone || graph.TypeOf(variable).name != "se2/1")
      throw Error(IndexName(folder), index.nodes[i].line, 1,
                  key.ToString() + " is not a pose of the plane in " + step.file + ", which line " +
                      std::to_string(step.line) + " says it is in");
    const Span<const double> value = graph.ValueOf(variable);
    poses.push_back({value[0], value[1], value[2]});
  }
  return poses;
}

}  // namespace graticule
