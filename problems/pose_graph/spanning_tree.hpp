#pragma once

#include <cstddef>
#include <cstdint>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// How a tree of measurements grows from its roots.
enum class Growth : std::uint8_t {
  kBreadthFirst,      ///< the fewest measurements to each pose
  kAlongChains,       ///< along consecutive keys of a family, and breadth first besides
  kLeastUncertainty,  ///< minimum spanning tree (Prim) of the traces of the covariances
};

struct SpanningTreeReport {
  std::size_t poses = 0;       ///< that were given a new value
  std::size_t roots = 0;       ///< poses that others were placed from
  std::size_t free_roots = 0;  ///< of these, those that nothing holds
};

/// Places the poses of a graph from one another, as Initialise says.  Fixed ones stay.
/// Time in proportion to the graph, but for the sorting of keys and, with kLeastUncertainty, of
/// factors.
SpanningTreeReport PlaceBySpanningTree(const Graph& graph, Growth growth, Values* values);

}  // namespace graticule
