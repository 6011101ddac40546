#pragma once

#include <cstddef>
#include <vector>

#include "graticule/problems/mapping/graph_sequence.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "graticule/solver/online.hpp"

namespace graticule {

/// The sequence of graphs G_1 .. G_n of a mission (thesis section 2.1), as an online solver would
/// have had them: every so many seconds of the log, with the nodes and factors that had come.  A
/// factor comes with the last of its nodes.
class MissionReplay : public GraphSequence {
 public:
  /// The mission must outlive it and stay as it is.  Throws Error (kUsage): `every_s` not above 0.
  MissionReplay(const Mission& mission, double every_s);

  /// Steps in which nothing came are left out.  The last graph is the whole one, and at its
  /// minimum.  Throws Error as Online does.
  bool Next(MissionStep* step) override;
  Graph Problem() const override { return online_.Problem(); }

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
