#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/problems/mapping/surface_points.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/option.hpp"
#include "graticule/solver/options.hpp"

namespace graticule {

/// How a log becomes a pose graph.  FrontEndOptionTable() describes each member.
struct FrontEndOptions {
  // nodes
  double node_distance = 0.2;  ///< m
  double node_turn = 0.2;      ///< rad
  // dead reckoning, from one scan to the next
  double odometry_sigma = 0.02;           ///< m
  double odometry_sigma_per_metre = 0.1;  ///< m a metre
  double odometry_sigma_yaw = 0.05;       ///< rad; laser and wheels are not read at one time
  double odometry_sigma_per_turn = 0.2;   ///< rad a rad
  // matching
  double max_range = 30;        ///< m
  double point_spacing = 0.02;  ///< m
  int local_nodes = 15;         ///< that a scan is matched against
  double drift_sigma = 0.005;  ///< m, of a match with the nodes before, besides what its points say
  double drift_sigma_yaw = 0.002;  ///< rad
  // closures
  double closure_reach = 3;          ///< m; places no farther apart than this are looked at
  double closure_window = 25;        ///< m; the farthest that a place is looked for
  double closure_score = 0.5;        ///< mean likelihood of a closure's points
  double closure_sigma = 0.02;       ///< m
  double closure_sigma_yaw = 0.004;  ///< rad
  int closure_rounds = 20;
  int overlap_rounds = 2;  ///< of refinement: all that overlaps is matched once more
  int threads = 0;         ///< 0: as many as the machine has
  /// Where each robot begins, in one frame, and how well that is known.  Empty: nobody knows.
  std::vector<PlanarPose> starts;
  double start_sigma = 0.5;      ///< m
  double start_sigma_yaw = 0.1;  ///< rad
  SolveOptions solve;
};

/// The one description of FrontEndOptions, but for the starts.
const std::vector<OptionRow<FrontEndOptions>>& FrontEndOptionTable();

/// A pose of the graph, and the scan that was taken there.
struct FrontEndNode {
  Key key;
  std::size_t scan = 0;  ///< into LaserLog::scans
};

struct FrontEndReport {
  std::size_t scans = 0, nodes = 0;
  std::size_t searches = 0;  ///< closures that were looked for
  std::size_t found = 0;     ///< of these, found
  std::size_t rejected = 0;  ///< of these, inconsistent
  std::size_t overlaps = 0;  ///< matches between passes once poses were known
  std::size_t rounds = 0;
  std::vector<std::uint32_t> piece_of_robot;  ///< robots of one piece are in one frame
  double seconds_follow = 0, seconds_close = 0, seconds_refine = 0;  ///< wall
};

/// A log as a pose graph, solved.
struct FrontEndResult {
  explicit FrontEndResult(Registry types) : graph(std::move(types)) {}

  /// se2/1 "robot:N" along each robot's way; between_se2/1 of the sources "odometry", "scan" (a
  /// match with the nodes before) and "loop".  The values are the solution; the first pose is
  /// fixed.
  Graph graph;
  std::vector<FrontEndNode> nodes;          ///< robot by robot, in the order of their keys
  std::vector<PlanarPose> world_from_node;  ///< of nodes
  std::vector<PlanarPose> world_from_scan;  ///< robot's pose at every scan of the log
  FrontEndReport report;
};

/// What is being done, and how much of it is done (0 to 1).  Says false to look for no more loops:
/// the graph is then of what is known so far.
using FrontEndObserver = std::function<bool(const std::string& stage, double done)>;

/// From raw scans to a solved pose graph:
///
/// 1. Every scan is matched against the last nodes, near where dead reckoning says it is; where the
///    robot has moved on or turned, it becomes a node.
/// 2. Places where the robot may have been before, by the uncertainty of the graph so far, are
///    looked for: a stretch of nodes against another.  What is found is verified by consistency
///    (SolveWithoutOutliers) and the graph solved; again, as long as this finds more.
/// 3. With poses known, all stretches that overlap are matched on their points, and the graph is
///    solved once more.
///
/// Deterministic whatever `threads` is.  Throws Error: no scan.
FrontEndResult BuildMission(const LaserLog& log, const Registry& types,
                            const FrontEndOptions& options = {},
                            const FrontEndObserver& watch = {});

}  // namespace graticule
