#include "graticule/problems/pose_graph/drawing.hpp"

#include <algorithm>
#include <map>

#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

constexpr std::uint32_t kNotDrawn = 0xffffffffu;

struct Axes {
  std::size_t x = 0, y = 1;
  const char* text = "";
};

bool IsPoint(const VariableType& type) {
  return type.name == "point2/1" || type.name == "point3/1";
}

// The two axes along which a 3D graph is widest: a wall is seen from the side, a floor from above.
Axes WidestAxes(const Graph& graph, const Values& values) {
  double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
  bool in_space = false;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    const std::string& type = graph.TypeOf(id).name;
    if (type != "se3/1" && type != "point3/1") continue;
    in_space = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], values[id][axis]);
      high[axis] = std::max(high[axis], values[id][axis]);
    }
  }
  if (!in_space) return {};
  int narrow = 2;
  for (int axis = 1; axis >= 0; --axis)
    if (high[axis] - low[axis] < 0.999 * (high[narrow] - low[narrow])) narrow = axis;
  if (narrow == 0) return {1, 2, "y to the right, z up"};
  if (narrow == 1) return {0, 2, "x to the right, z up"};
  return {0, 1, "x to the right, y up"};
}

GraphPlot::EdgeKind KindOf(const Graph& graph, const FactorView& factor) {
  for (const VariableId id : factor.variables)
    if (IsPoint(graph.TypeOf(id))) return GraphPlot::EdgeKind::kLandmark;
  if (factor.source == "odometry") return GraphPlot::EdgeKind::kOdometry;
  const Key& a = graph.KeyOf(factor.variables[0]);
  const Key& b = graph.KeyOf(factor.variables[1]);
  const bool consecutive =
      a.Family() == b.Family() && (a.Number() + 1 == b.Number() || b.Number() + 1 == a.Number());
  return factor.source.empty() && consecutive ? GraphPlot::EdgeKind::kOdometry
                                              : GraphPlot::EdgeKind::kLoop;
}

}  // namespace

GraphPlot PlotOf(const Graph& graph, const Values& before, const Values& after,
                 const std::string& title) {
  GraphPlot plot;
  plot.title = title;
  const Axes axes = WidestAxes(graph, after);
  plot.subtitle = axes.text;
  std::vector<std::uint32_t> position(graph.VariableCount(), kNotDrawn);
  std::map<std::string, std::uint32_t, std::less<>> groups;
  for (const VariableId id : graph.KeyOrder()) {
    const VariableType& type = graph.TypeOf(id);
    if (!IsPose(type) && !IsPoint(type)) continue;
    std::uint32_t group_id = 0;  // landmarks are marks, in no robot's colour
    if (IsPose(type)) {
      const auto [group, is_new] = groups.emplace(std::string(graph.KeyOf(id).Family()),
                                                  static_cast<std::uint32_t>(plot.groups.size()));
      if (is_new) plot.groups.emplace_back(graph.KeyOf(id).Family());
      group_id = group->second;
    }
    const auto node = [&](const Values& values) {
      return GraphPlot::Node{values[id][axes.x], values[id][axes.y], group_id};
    };
    position[id] = static_cast<std::uint32_t>(plot.after.size());
    if (IsPoint(type)) plot.landmarks.push_back(position[id]);
    plot.before.push_back(node(before));
    plot.after.push_back(node(after));
  }
  if (plot.groups.empty()) plot.groups.emplace_back("points");
  const std::vector<double> chi2 = FactorChi2(graph, after);
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    if (factor.variables.size() != 2) continue;
    GraphPlot::Edge edge;
    edge.a = position[factor.variables[0]];
    edge.b = position[factor.variables[1]];
    if (edge.a == kNotDrawn || edge.b == kNotDrawn) continue;
    edge.kind = KindOf(graph, factor);
    edge.chi2 = chi2[id];
    edge.residuals = graph.ResidualSize(id);
    plot.edges.push_back(edge);
  }
  return plot;
}

}  // namespace graticule
