#pragma once

#include <cstddef>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// G_i of a mission: the nodes that have come by then, and where its maximum likelihood has them.
struct MissionStep {
  double time = 0;                           ///< s, of the log
  std::size_t nodes = 0;                     ///< the first so many of Mission::nodes
  std::vector<PlanarPose> world_from_robot;  ///< of these
};

/// The graphs G_1 .. G_n of a mission (thesis section 2.1), one after the other, from wherever they
/// come.
class GraphSequence {
 public:
  virtual ~GraphSequence() = default;

  /// The next graph; false after the last.
  virtual bool Next(MissionStep* step) = 0;
  /// The graph of the last step at its poses, to be written or solved by others.
  virtual Graph Problem() const = 0;
};

}  // namespace graticule
