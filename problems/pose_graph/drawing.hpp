#pragma once

#include <string>

#include "graticule/io/graph_plot.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// A graph of poses and landmarks as a picture's data, before and after: variables of type se2,
/// se3, point2, point3 by their position, factors between two of them as edges with their chi2 at
/// `after`. In 3D the two world axes along which the graph is widest.  Other variables and factors
/// are left out.
GraphPlot PlotOf(const Graph& graph, const Values& before, const Values& after,
                 const std::string& title);

}  // namespace graticule
