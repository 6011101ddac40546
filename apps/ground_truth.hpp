#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/pose_graph/trajectory_error.hpp"

namespace graticule::apps {

/// What `--ground-truth`, `--align` and `--rpe-distance` say, read for one problem.
class TruthOf {
 public:
  /// Nothing to compare with where no file is named.  A problem file's values are the truth; any
  /// other file is a TUM trajectory, one a family as TrajectoryFiles names them.  Throws Error: a
  /// file cannot be read, or matches no pose of the graph.
  TruthOf(const Comparing& comparing, const Reading& reading, const Graph& graph,
          const Console& console);

  /// How far values of the graph are from the truth; empty where none was named.
  std::optional<Accuracy> Judge(const Graph& graph, const Values& values) const;

 private:
  std::string file_;
  GroundTruth truth_;
  TrajectoryErrorOptions options_;
};

/// What `--align` and `--rpe-distance` say.
TrajectoryErrorOptions ErrorOptionsOf(const Comparing& comparing);

/// True trajectories of robots by name, as TUM: of one robot `path` itself, of several
/// `truth.robot1.tum`, ... for `truth.tum`; those that are there.  Throws Error: none is.
std::map<std::string, std::vector<StampedPose>> TrueTrajectories(
    const std::string& path, const std::vector<std::string>& robots, const Console& console);

}  // namespace graticule::apps
