#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "graticule/io/g2o_laser.hpp"
#include "graticule/io/mission_index.hpp"
#include "graticule/problems/mapping/mission.hpp"

namespace graticule {

/// The index of a mission, robots without a node left out, and no graphs yet.  The scans are said
/// to be in `scans/ROBOT.g2o.gz`.  Throws Error (kOther): a robot whose nodes' keys are of several
/// families.
MissionIndex IndexOf(const Mission& mission);

/// The scans of a robot's nodes as a g2o file, each after its vertex, which is where the poses have
/// it; without edges.
std::string FormatScans(const Mission& mission, std::uint32_t robot,
                        const std::vector<PlanarPose>& world_from_robot);

/// Holds the first variable of each piece of a graph that nothing says the place of: robots that
/// have not met yet.  Where they are stays the same, and the graph can be solved by itself.
void HoldEachPiece(Graph* graph);

/// A mission from its parts: the index, each robot's scans, and the last graph of its sequence.
/// `folder` is for errors.  Throws Error (input), with file and line: a scan of a node that the
/// index does not have, a node without a scan or with two, or that the graph does not have.
Mission MissionFromParts(const MissionIndex& index, std::vector<G2oLaser> scans, Graph graph,
                         const std::string& folder);

/// Where the nodes of a graph of the sequence are in that graph.  Throws Error (input): one of them
/// is not there, or is no pose of the plane.
std::vector<PlanarPose> PosesOf(const MissionIndex& index, const MissionIndex::Graph& step,
                                const Graph& graph, const std::string& folder);

}  // namespace graticule
