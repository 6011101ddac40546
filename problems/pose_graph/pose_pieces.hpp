#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// A measurement between two poses; whole: it says all of one from the other.
struct PoseTie {
  VariableId a, b;
  bool is_whole;
};

/// A measurement of a pose in the world; whole: it says all of it.
struct PoseAnchor {
  VariableId pose;
  bool is_whole;
};

/// Pieces of a graph (poses that ties join), and the poses whose place a linear system can find.
struct PosePieces {
  static constexpr int kHeld = -1;
  static constexpr std::uint32_t kWorld = 0;  ///< group of what something ties to the world
  static constexpr std::uint32_t kNoGroup = 0xffffffffu;

  std::vector<int> index;            ///< by variable: its node, or kHeld
  std::vector<std::uint32_t> group;  ///< by variable: poses that agree on a frame share one
  std::vector<VariableId> poses;     ///< by node, in the order of keys
  std::size_t solved = 0;            ///< pieces that have nodes, or are held as a whole
  std::size_t kept =
      0;  ///< pieces that have none, because ties that are not whole leave a pose loose
};

/// Held are fixed poses, and in a piece with neither a fixed pose nor a whole anchor one pose: the
/// smallest key with an anchor, else the smallest.  `order`: all variables by key; `is_pose`: by
/// variable type.
PosePieces FindPosePieces(const Graph& graph, const std::vector<VariableId>& order,
                          const std::vector<bool>& is_pose, const std::vector<PoseTie>& ties,
                          const std::vector<PoseAnchor>& anchors);

}  // namespace graticule
