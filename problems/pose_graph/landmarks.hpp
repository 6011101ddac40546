#pragma once

#include <cstddef>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// How many landmarks were placed, and how many of them at an assumed range or direction.
struct PlacedLandmarks {
  std::size_t placed = 0;
  std::size_t assumed = 0;
};

/// Places the landmarks of a graph from the poses in `values`, as Initialise says.  Fixed ones
/// stay.
PlacedLandmarks PlaceLandmarks(const Graph& graph, Values* values);

}  // namespace graticule
