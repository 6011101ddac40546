#include "fuzz.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/mapping/recorded_mission.hpp"

// The parts of a recorded mission's folder, zeros between: its index, the last graph of its
// sequence, and every robot's scans.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const Registry types = Builtins();
  const auto part = [&] {
    const std::string_view own = text.substr(0, text.find('\0'));
    text.remove_prefix(std::min(own.size() + 1, text.size()));
    return own;
  };
  const MissionIndex index = ParseMissionIndex(part(), "fuzz/mission.index");
  Graph graph = ParseProblem(part(), "fuzz/last.fg", types, {}).graph;
  const std::string_view laser = part();
  std::vector<G2oLaser> scans;
  for (std::size_t i = 0; i < index.robots.size() && i < 100; ++i)
    scans.push_back(ParseG2oLaser(laser, "fuzz/robot.g2o"));
  if (scans.size() < index.robots.size()) return;
  const Mission mission = MissionFromParts(index, std::move(scans), std::move(graph), "fuzz");
  for (const MissionNode& node : mission.nodes)
    if (node.scan >= mission.log.scans.size()) std::abort();
  for (const MissionIndex::Graph& step : index.graphs) PosesOf(index, step, mission.graph, "fuzz");
}
