#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "graticule/io/gnss.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "graticule/problems/mapping/relation_error.hpp"
#include "graticule/solver/options.hpp"

namespace graticule {

struct GnssOptions {
  std::optional<Geodetic> datum;        ///< empty: the first fix that is used
  double antenna_x = 0, antenna_y = 0;  ///< m, on the robot: ahead, to the left
  double loss = 2;                      ///< deviations from where on a fix counts less (Cauchy)
  SolveOptions solve;
};

struct GnssReport {
  std::size_t used = 0;
  std::size_t outside = 0;   ///< of times when its robot's log says nothing
  std::size_t off = 0;       ///< used, but more than five deviations from the solution
  double rms_m = 0;          ///< of the others
  double sigma_yaw_rad = 0;  ///< of the map's direction before the solve, the worst of all pieces
  std::vector<std::string> without;  ///< robots whose piece of the graph has no fix: not moved
};

/// Where robots were, by time, as the mission's graph has them: a robot's poses at its scans.
using RobotTracks = std::vector<std::vector<TimedPose>>;

/// Poses of the nodes, where there are no others.
RobotTracks TracksOfNodes(const Mission& mission);

/// Makes a mission's graph, which is solved, one of a world that is east and north of a datum:
/// each piece of the graph is laid onto its fixes (AlignToGround), a factor `geodetic_se2/1` of the
/// source "gnss" is added for each fix, and the graph solved.  A fix is one of the node before,
/// with the way since then added to the antenna's place.  Poses that were held are so no more;
/// instead the first of each piece has a prior ("gnss start") of ten times the deviation that the
/// alignment leaves, so that graphs of the first few fixes have a direction.  Deterministic.
///
/// Throws Error (input) with `name` and the line: a fix of a robot that is not there; no fix at a
/// time of the logs; fixes that lie too close together, or of which too few agree, to say where
/// east is; a graph that has positions of another world.
GnssReport AddGnss(const std::vector<GnssFix>& fixes, const std::string& name, RobotTracks tracks,
                   const GnssOptions& options, Mission* mission);

/// The same graph with `position_se2/1` for each `geodetic_se2/1`, for formats that have no places
/// on the Earth: where the body is if it is turned as the graph has it.
Graph WithPlainPositions(const Graph& graph);

/// The datum of a graph's `geodetic_se2/1` factors.  Empty: there are none.  Throws Error (input):
/// factors of several data.
std::optional<Geodetic> DatumOf(const Graph& graph);

}  // namespace graticule
