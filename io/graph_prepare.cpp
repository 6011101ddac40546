#include "graticule/io/graph_panel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule::plot {
namespace {

using Node = GraphPlot::Node;
using Edge = GraphPlot::Edge;
using EdgeKind = GraphPlot::EdgeKind;

constexpr std::size_t kMaxLoops = 120000, kMaxLandmarkEdges = 60000;
/// The initial guess may lie far outside; the window grows to this many times the result's size.
constexpr double kMaxGrowth = 2.5;

bool Finite(const Node& node) { return std::isfinite(node.x_m) && std::isfinite(node.y_m); }

Box Bounds(const std::vector<Node>& nodes) {
  Box box;
  for (const Node& node : nodes)
    if (Finite(node)) box.Add(node.x_m, node.y_m);
  return box;
}

// What both panels show [m].
Box Window(const GraphPlot& graph) {
  Box window = Bounds(graph.after);
  const Box before = Bounds(graph.before);
  if (window.Empty()) window = before;
  if (window.Empty()) window.Add(0, 0);
  if (!before.Empty()) {
    const double reach = 0.5 * (kMaxGrowth - 1) * std::max({window.Width(), window.Height(), 1.0});
    const Box after = window;
    window.Add(std::max(before.low_x, after.low_x - reach),
               std::max(before.low_y, after.low_y - reach));
    window.Add(std::min(before.high_x, after.high_x + reach),
               std::min(before.high_y, after.high_y + reach));
  }
  const double least = std::max({window.Width(), window.Height(), 1e-6}) * 1e-3;
  window.Add(window.low_x - least, window.low_y - least);
  window.Add(window.high_x + least, window.high_y + least);
  return window;
}

double PerResidual(const Edge& edge) {
  return edge.residuals > 0 ? edge.chi2 / edge.residuals : edge.chi2;
}

void Thin(std::size_t budget, std::vector<std::uint32_t>* edges) {
  const std::size_t count = edges->size();
  if (count <= budget) return;
  for (std::size_t i = 0; i < budget; ++i) (*edges)[i] = (*edges)[i * count / budget];
  edges->resize(budget);
}

Loops SortLoops(const std::vector<Edge>& edges) {
  Loops loops;
  std::vector<double> sizes;
  for (const Edge& edge : edges) {
    if (edge.kind != EdgeKind::kLoop) continue;
    ++loops.count;
    const double size = PerResidual(edge);
    if (std::isfinite(size) && size > 0) sizes.push_back(size);
  }
  // 1 is what the noise expects.  The bar always reaches far beyond it, so that a colour is never
  // alarming where nothing is wrong; and does not follow the small ones down, which say little.
  double high = 100, low = 0.1;
  if (!sizes.empty()) {
    const auto median = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), median, sizes.end());
    low = std::min(low, *median);
    high = std::max(high, *std::max_element(sizes.begin(), sizes.end()));
  }
  high = std::pow(10, std::ceil(std::log10(high) - 1e-9));
  low = std::pow(10, std::floor(std::log10(std::clamp(low, high * 1e-6, high * 1e-2)) + 1e-9));
  loops.scale = LogAxis(low, high, 8);

  loops.steps.resize(kRampSteps);
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    if (edges[i].kind != EdgeKind::kLoop) continue;
    const double size = PerResidual(edges[i]);
    const double place = size <= low ? 0 : std::isfinite(size) ? loops.scale.Place(size) : 1;
    const auto step = static_cast<std::size_t>(place * kRampSteps);
    loops.steps[std::min(step, kRampSteps - 1)].push_back(i);
  }
  std::size_t budget = kMaxLoops;
  for (std::size_t step = kRampSteps; step-- > 0;) {
    Thin(budget, &loops.steps[step]);
    budget -= loops.steps[step].size();
  }
  loops.drawn = kMaxLoops - budget;
  return loops;
}

}  // namespace

void Box::Add(double x, double y) {
  if (Empty()) {
    *this = {x, y, x, y};
    return;
  }
  low_x = std::min(low_x, x);
  low_y = std::min(low_y, y);
  high_x = std::max(high_x, x);
  high_y = std::max(high_y, y);
}

double Loops::LowerBound(std::size_t step) const {
  return scale.low * std::pow(scale.high / scale.low, static_cast<double>(step) / kRampSteps);
}

double GraphDrawing::PixelsPerMetre() const {
  return 0.94 * std::min(panel_width / window.Width(), panel_height / window.Height());
}

GraphDrawing PrepareGraph(const GraphPlot& graph) {
  const std::size_t nodes = graph.after.size();
  if (!graph.before.empty() && graph.before.size() != nodes)
    throw Error(
        fmt::format("plot of a graph: {} nodes before, {} after", graph.before.size(), nodes),
        ErrorKind::kOther);
  GraphDrawing drawing{graph, SortLoops(graph.edges), Window(graph), std::vector<char>(nodes), {}};
  const auto check = [&](std::uint32_t node) {
    if (node >= nodes)
      throw Error(fmt::format("plot of a graph: node {} of {}", node, nodes), ErrorKind::kOther);
  };
  for (const std::uint32_t node : graph.landmarks) {
    check(node);
    drawing.is_landmark[node] = 1;
  }
  for (std::uint32_t i = 0; i < graph.edges.size(); ++i) {
    check(graph.edges[i].a);
    check(graph.edges[i].b);
    if (graph.edges[i].kind == EdgeKind::kLandmark) drawing.landmark_edges.push_back(i);
  }
  Thin(kMaxLandmarkEdges, &drawing.landmark_edges);
  drawing.poses = static_cast<std::size_t>(
      std::count(drawing.is_landmark.begin(), drawing.is_landmark.end(), 0));
  drawing.decimals = nodes + graph.edges.size() > 20000 ? 1 : 2;

  const int panels = graph.before.empty() ? 1 : 2;
  drawing.panel_width = (kGraphWidth - kGraphMargin * (panels + 1)) / panels;
  const double natural = drawing.panel_width * drawing.window.Height() / drawing.window.Width();
  drawing.panel_height = std::clamp(natural, 220.0, panels == 1 ? 720.0 : 600.0);
  return drawing;
}

}  // namespace graticule::plot
