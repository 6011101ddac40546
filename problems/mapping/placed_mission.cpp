#include "graticule/problems/mapping/placed_mission.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "graticule/factors/make.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// What the log's corrector knew is not said; the values do not depend on it.
constexpr double kSigma_m = 0.02, kSigma_rad = 0.005;

struct Last {
  Key key;
  PlanarPose world_from_robot;
};

}  // namespace

Mission MissionAsPlaced(LaserLog log, const Registry& types, double node_distance_m,
                        double node_turn_rad) {
  if (!(node_distance_m > 0 && node_turn_rad > 0))
    throw Error("expected nodes a distance and a turn above 0 apart", ErrorKind::kUsage);
  Graph graph(types);
  std::vector<MissionNode> nodes;
  std::vector<std::optional<Last>> last(log.robots.size());
  std::vector<std::uint64_t> count(log.robots.size(), 0);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const LaserScan& scan = log.scans[i];
    const PlanarPose& here = scan.odom_from_robot;
    std::optional<Last>& before = last[scan.robot];
    const PlanarPose step = before ? Inverse(before->world_from_robot) * here : PlanarPose();
    if (before && std::hypot(step.x, step.y) < node_distance_m &&
        std::abs(step.yaw) < node_turn_rad)
      continue;
    const Key key(log.robots[scan.robot], count[scan.robot]++);
    nodes.push_back({graph.Add(key, "se2/1", {here.x, here.y, here.yaw}, !before), i});
    if (before)
      graph.Add(BetweenSe2Factor(before->key, key, {step.x, step.y, step.yaw},
                                 Noise::Sigmas({kSigma_m, kSigma_m, kSigma_rad}), "log"));
    before = Last{key, here};
  }
  Mission mission{std::move(log), std::move(graph), std::move(nodes)};
  std::stable_sort(mission.nodes.begin(), mission.nodes.end(),
                   [&](const MissionNode& a, const MissionNode& b) {
                     return mission.TimeOf(a) < mission.TimeOf(b);
                   });
  return mission;
}

}  // namespace graticule
