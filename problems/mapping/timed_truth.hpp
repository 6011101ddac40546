#pragma once

#include <map>
#include <string>
#include <vector>

#include "graticule/io/trajectory.hpp"
#include "graticule/problems/mapping/graph_sequence.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "graticule/problems/pose_graph/trajectory_error.hpp"

namespace graticule {

/// The poses of a mission's nodes beside true ones, robot by robot, by the log's times: a truth is
/// the one at that time (s), between the two about it if none is within a millisecond, and those
/// no more than two seconds apart; other nodes have none.  `truth` is by the robots' names, in the
/// order of time.  Throws Error (kUsage): not a single node has a truth.
std::vector<TrajectoryPair> PairByTime(
    const Mission& mission, const MissionStep& step,
    const std::map<std::string, std::vector<StampedPose>>& truth);

}  // namespace graticule
