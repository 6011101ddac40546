#pragma once

#include <cstddef>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "graticule/solver/online.hpp"

namespace graticule {

/// G_i of a mission: the nodes that have come by then, and where its maximum likelihood has them.
struct MissionStep {
  double time = 0;                           ///< s, of the log
  std::size_t nodes = 0;                     ///< the first so many of Mission::nodes
  std::vector<PlanarPose> world_from_robot;  ///< of these
};

/// The sequence of graphs G_1 .. G_n of a mission (thesis section 2.1), as an online solver would
/// have had them: every so many seconds of the log, with the nodes and factors that had come.  A
/// factor comes with the last of its nodes.
class MissionReplay {
 public:
  /// The mission must outlive it and stay as it is.  Throws Error (kUsage): `every_s` not above 0.
  MissionReplay(const Mission& mission, double every_s);

  /// The next graph; false after the last.  Steps in which nothing came are left out.  The last
  /// graph is the whole one, and at its minimum.  Throws Error as Online does.
  bool Next(MissionStep* step);

  /// The graph of the last step, to be written or solved by others.
  Graph Problem() const { return online_.Problem(); }

 private:
  void Enter(std::size_t node);
  std::vector<double> GuessOf(std::size_t node) const;

  const Mission& mission_;
  double every_s_;
  Online online_;
  std::vector<std::size_t> node_of_;                  // by variable; the number of nodes: none
  std::vector<std::vector<FactorId>> comes_with_;     // by node
  std::vector<VariableId> online_of_;                 // by variable
  std::vector<std::vector<VariableId>> others_with_;  // by node: variables that are no nodes
  std::vector<double> current_;                       // of all nodes so far, x y yaw
  std::size_t entered_ = 0;
};

}  // namespace graticule
