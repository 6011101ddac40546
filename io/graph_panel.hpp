#pragma once

#include <cstdint>
#include <vector>

#include "graticule/io/graph_plot.hpp"
#include "graticule/io/plot_style.hpp"
#include "graticule/io/svg.hpp"

namespace graticule::plot {

constexpr double kGraphWidth = 1200, kGraphMargin = 16;

/// A rectangle in metres, empty until a point is added.
struct Box {
  double low_x = 1, low_y = 1, high_x = -1, high_y = -1;

  bool Empty() const { return high_x < low_x; }
  double Width() const { return high_x - low_x; }
  double Height() const { return high_y - low_y; }
  void Add(double x, double y);
};

/// The closures that are drawn, sorted by their chi2 per residual into the steps of the ramp.
struct Loops {
  Axis scale;
  std::vector<std::vector<std::uint32_t>> steps;  ///< positions in GraphPlot::edges
  std::size_t count = 0, drawn = 0;

  double LowerBound(std::size_t step) const;
};

/// What DrawGraph decides before it draws.  Refers to the graph.
struct GraphDrawing {
  const GraphPlot& graph;
  Loops loops;
  Box window;  ///< what each panel shows [m]
  std::vector<char> is_landmark;
  std::vector<std::uint32_t> landmark_edges;
  std::size_t poses = 0;
  double panel_width = 0, panel_height = 0;  ///< [px]
  int decimals = 2;

  double PixelsPerMetre() const;
};

/// Throws Error as DrawGraph does.
GraphDrawing PrepareGraph(const GraphPlot& graph);

/// The nodes, which are the graph's `before` or `after`, and all edges; (0, 0) is the panel's upper
/// left corner.
void DrawPanel(const GraphDrawing& drawing, const std::vector<GraphPlot::Node>& nodes, Svg* svg);

}  // namespace graticule::plot
