#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "graticule/problems/mapping/live_map.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"

namespace graticule {

/// A mission's map, and the updates that led to it, one for each graph of its sequence.
struct MappedMission {
  std::vector<MapUpdate> updates;  ///< of the graphs in order; of a mission that was hurried the
                                   ///< last is the last graph's
  std::shared_ptr<const OccupancyMap> map;  ///< with every node where the last graph has it
};

/// Draws a sequence of graphs G_1 .. G_n of a mission as a live map would have: of each, the nodes
/// that are new and those that moved.  With a deadline, updates after the last graph finish what
/// was left over; the last of `updates` has what all of these did, one after the other.  `keep_on`
/// is asked after each update; where it says no, the last graph is the next.
MappedMission MapMission(const Mission& mission, const std::vector<MissionStep>& steps,
                         const LiveMapOptions& options,
                         double deadline_s = std::numeric_limits<double>::infinity(),
                         const std::function<bool(std::size_t step)>& keep_on = {});

/// The map of all nodes where a graph has them, drawn at once: what others are compared with.
std::shared_ptr<const OccupancyMap> MapOfAllNodes(const Mission& mission, const MissionStep& step,
                                                  LiveMapOptions options);

}  // namespace graticule
