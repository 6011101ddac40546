#include "graticule/problems/mapping/map_mission.hpp"

namespace graticule {
namespace {

void AddNode(const Mission& mission, std::size_t node, const PlanarPose& world_from_robot,
             LiveMap* map) {
  const LaserScan& scan = mission.log.scans[mission.nodes[node].scan];
  map->AddNode(scan.robot, mission.log.GeometryOf(scan), mission.log.RangesOf(scan),
               world_from_robot);
}

// What two updates did together.
void AddWork(const MapUpdate& before, MapUpdate* update) {
  update->seconds += before.seconds;
  update->regenerated_slices += before.regenerated_slices;
  update->regenerated_nodes += before.regenerated_nodes;
  MapChange& change = update->change;
  change.dirty_tiles += before.change.dirty_tiles;
  const auto put_first = [](const auto& first, auto* list) {
    list->insert(list->begin(), first.begin(), first.end());
  };
  put_first(before.change.changed_tiles, &change.changed_tiles);
  put_first(before.change.flips, &change.flips);
  put_first(before.change.frontier_came, &change.frontier_came);
  put_first(before.change.frontier_went, &change.frontier_went);
}

}  // namespace

MappedMission MapMission(const Mission& mission, const std::vector<MissionStep>& steps,
                         const LiveMapOptions& options, double deadline_s,
                         const std::function<bool(std::size_t)>& keep_on) {
  LiveMap map(options);
  MappedMission mapped;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const MissionStep& step = steps[i];
    for (std::size_t node = 0; node < step.nodes; ++node) {
      if (node < map.NodeCount())
        map.UpdatePose(static_cast<NodeId>(node), step.world_from_robot[node]);
      else
        AddNode(mission, node, step.world_from_robot[node], &map);
    }
    mapped.updates.push_back(map.Update(deadline_s));
    if (keep_on && !keep_on(i) && i + 2 < steps.size()) i = steps.size() - 2;
  }
  const auto is_behind = [&] {
    return !mapped.updates.empty() &&
           !(mapped.updates.back().left_over.empty() && mapped.updates.back().waiting.empty());
  };
  while (is_behind()) {
    MapUpdate more = map.Update(deadline_s);
    AddWork(mapped.updates.back(), &more);
    mapped.updates.back() = std::move(more);
  }
  map.UpdateExactly();
  mapped.map = map.Map();
  return mapped;
}

std::shared_ptr<const OccupancyMap> MapOfAllNodes(const Mission& mission, const MissionStep& step,
                                                  LiveMapOptions options) {
  options.method = MapMethod::kNaive;
  LiveMap map(options);
  for (std::size_t node = 0; node < step.nodes; ++node)
    AddNode(mission, node, step.world_from_robot[node], &map);
  map.Update();
  return map.Map();
}

}  // namespace graticule
