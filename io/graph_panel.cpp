#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "graticule/io/graph_panel.hpp"
#include "graticule/io/readable.hpp"

namespace graticule::plot {
namespace {

using Node = GraphPlot::Node;
using Edge = GraphPlot::Edge;
using EdgeKind = GraphPlot::EdgeKind;

/// Closures above this chi2 per residual are drawn over the trajectories.
constexpr double kOnTop = 3;

bool Finite(const Node& node) { return std::isfinite(node.x_m) && std::isfinite(node.y_m); }

// One panel's way from metres to pixels; y points up in the world, down on paper.
class Panel {
 public:
  Panel(const GraphDrawing& drawing, const std::vector<Node>& nodes)
      : drawing_(drawing), nodes_(nodes), scale_(drawing.PixelsPerMetre()) {}

  void Draw(Svg* svg) const {
    const Attributes faint = [] {
      Attributes attributes = Frame();
      attributes.insert(attributes.end(), {{"stroke-width", ".5"}, {"stroke-opacity", ".7"}});
      return attributes;
    }();
    DrawSegments(svg, drawing_.landmark_edges, faint, "");
    DrawLoops(svg, false);
    DrawTrajectories(svg);
    DrawLandmarks(svg);
    DrawLoops(svg, true);
    DrawStarts(svg);
  }

 private:
  std::pair<double, double> Place(std::uint32_t node) const {
    constexpr double kFar = 1e5;  // far outside; cairo's coordinates end at 8e6
    const Box& window = drawing_.window;
    const double x = (nodes_[node].x_m - 0.5 * (window.low_x + window.high_x)) * scale_;
    const double y = (nodes_[node].y_m - 0.5 * (window.low_y + window.high_y)) * scale_;
    return {0.5 * drawing_.panel_width + std::clamp(x, -kFar, kFar),
            0.5 * drawing_.panel_height - std::clamp(y, -kFar, kFar)};
  }

  bool Drawable(const Edge& edge) const { return Finite(nodes_[edge.a]) && Finite(nodes_[edge.b]); }

  // In pieces: cairo unites the strokes of one path, which takes far longer than drawing them where
  // thousands cross.
  void DrawSegments(Svg* svg, const std::vector<std::uint32_t>& edges, const Attributes& stroke,
                    const std::string& title) const {
    constexpr std::size_t kPiece = 100;
    PathData path(drawing_.decimals);
    std::size_t in_piece = 0;
    for (const std::uint32_t i : edges) {
      const Edge& edge = drawing_.graph.edges[i];
      if (!Drawable(edge)) continue;
      const auto [ax, ay] = Place(edge.a);
      const auto [bx, by] = Place(edge.b);
      path.Segment(ax, ay, bx, by);
      if (++in_piece < kPiece) continue;
      svg->Path(path, stroke, title);
      path = PathData(drawing_.decimals);
      in_piece = 0;
    }
    if (!path.Empty()) svg->Path(path, stroke, title);
  }

  void DrawLoops(Svg* svg, bool on_top) const {
    const Loops& loops = drawing_.loops;
    const double base = loops.drawn < 300 ? 1.5 : loops.drawn < 5000 ? 1 : 0.7;
    for (std::size_t step = 0; step < kRampSteps; ++step) {
      const double bound = loops.LowerBound(step);
      if (loops.steps[step].empty() || (bound >= kOnTop * 0.9) != on_top) continue;
      Attributes stroke = RampStroke(step, on_top ? base * 1.5 : base);
      DrawSegments(
          svg, loops.steps[step], stroke,
          fmt::format("{} loop closures, chi2 per residual {} {}",
                      ReadableCount(loops.steps[step].size()), step == 0 ? "below" : "from",
                      ReadableNumber(loops.LowerBound(step == 0 ? 1 : step), 2)));
    }
  }

  void DrawTrajectories(Svg* svg) const {
    const GraphPlot& graph = drawing_.graph;
    const std::size_t groups = std::max<std::size_t>(1, graph.groups.size());
    std::vector<PathData> paths(groups, PathData(drawing_.decimals));
    constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> pen(groups, kNowhere);
    std::vector<char> on_a_line(nodes_.size());
    for (const Edge& edge : graph.edges) {
      if (edge.kind != EdgeKind::kOdometry || !Drawable(edge)) continue;
      const std::size_t group = std::min<std::size_t>(nodes_[edge.a].group, groups - 1);
      const auto [ax, ay] = Place(edge.a);
      const auto [bx, by] = Place(edge.b);
      if (pen[group] != edge.a) paths[group].MoveTo(ax, ay);
      paths[group].LineTo(bx, by);
      pen[group] = edge.b;
      on_a_line[edge.a] = on_a_line[edge.b] = 1;
    }
    const double width = drawing_.poses < 300 ? 2 : drawing_.poses < 5000 ? 1.3 : 1;
    std::vector<PathData> dots(groups, PathData(drawing_.decimals));
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
      if (!drawing_.is_landmark[i] && Finite(nodes_[i]) &&
          (drawing_.poses < 300 || !on_a_line[i])) {
        const auto [x, y] = Place(i);
        dots[std::min<std::size_t>(nodes_[i].group, groups - 1)].Dot(x, y);
      }
    for (std::size_t group = 0; group < groups; ++group) {
      Attributes stroke = GroupStroke(group, width);
      stroke.emplace_back("stroke-linejoin", "round");
      svg->Path(paths[group], stroke, group < graph.groups.size() ? graph.groups[group] : "");
      stroke = GroupStroke(group, drawing_.poses < 300 ? 5 : 2);
      stroke.back().second.clear();  // no dashes
      stroke.emplace_back("stroke-linecap", "round");
      svg->Path(dots[group], stroke);
    }
  }

  void DrawLandmarks(Svg* svg) const {
    PathData dots(drawing_.decimals);
    for (const std::uint32_t node : drawing_.graph.landmarks)
      if (Finite(nodes_[node])) {
        const auto [x, y] = Place(node);
        dots.Dot(x, y);
      }
    const std::size_t count = drawing_.graph.landmarks.size();
    svg->Path(dots,
              MarkStroke(count < 500    ? 4
                         : count < 5000 ? 2.5
                                        : 1.2),
              ReadableCount(count) + " landmarks");
  }

  // A ring where each group's trajectory begins.
  void DrawStarts(Svg* svg) const {
    std::vector<char> seen(std::max<std::size_t>(1, drawing_.graph.groups.size()));
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
      const std::size_t group = std::min<std::size_t>(nodes_[i].group, seen.size() - 1);
      if (drawing_.is_landmark[i] || !Finite(nodes_[i]) || seen[group]) continue;
      seen[group] = 1;
      const auto [x, y] = Place(i);
      Attributes ring = Paper();
      ring[0].second += " " + GroupStroke(group, 2)[0].second;
      ring[2] = GroupStroke(group, 2)[1];
      ring.emplace_back("stroke-width", "2");
      svg->Circle(x, y, 4.5, ring,
                  "start of " + (drawing_.graph.groups.empty() ? std::string("the trajectory")
                                                               : drawing_.graph.groups[group]));
    }
  }

  const GraphDrawing& drawing_;
  const std::vector<Node>& nodes_;
  double scale_;
};

}  // namespace

void DrawPanel(const GraphDrawing& drawing, const std::vector<Node>& nodes, Svg* svg) {
  Panel(drawing, nodes).Draw(svg);
}

}  // namespace graticule::plot
