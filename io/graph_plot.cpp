#include "graticule/io/graph_plot.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/graph_panel.hpp"
#include "graticule/io/plot_style.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

using plot::Attributes;
using plot::GraphDrawing;

constexpr double kStripHeight = 28;  // under a panel's picture, for the scale bar
constexpr double kBarWidth = 300, kRowHeight = 20;

void DrawFramedPanel(const GraphDrawing& drawing, const std::vector<GraphPlot::Node>& nodes,
                     const std::string& label, double left, double top, Svg* svg) {
  const double width = drawing.panel_width, height = drawing.panel_height;
  svg->Text(left, top - 8, plot::Shorten(label, width, 13), plot::Ink(13, {}, true));
  svg->Rect(left, top, width, height + kStripHeight, plot::Paper());
  // An inner document cuts off what lies outside.
  svg->Open("svg", {{"x", SvgNumber(left)},
                    {"y", SvgNumber(top)},
                    {"width", SvgNumber(width)},
                    {"height", SvgNumber(height)},
                    {"viewBox", "0 0 " + SvgNumber(width) + " " + SvgNumber(height)}});
  plot::DrawPanel(drawing, nodes, svg);
  svg->Close();
  plot::DrawScaleBar(drawing.PixelsPerMetre(), drawing.panel_width, left + 12,
                     top + height + 0.5 * kStripHeight, svg);
}

void DrawColourBar(const plot::Loops& loops, double left, double top, Svg* svg) {
  const double step_width = kBarWidth / plot::kRampSteps;
  std::string title = ReadableCount(loops.count) + " loop closures";
  if (loops.drawn < loops.count) title += " (" + ReadableCount(loops.drawn) + " drawn)";
  svg->Text(left, top + 11, title + ": χ² per residual at the end", plot::Ink(11));
  for (std::size_t step = 0; step < plot::kRampSteps; ++step)
    svg->Rect(left + static_cast<double>(step) * step_width, top + 18, step_width, 9,
              plot::RampFill(step),
              ReadableCount(loops.steps[step].size()) + " drawn, from " +
                  ReadableNumber(loops.LowerBound(step), 2));
  for (const plot::Tick& tick : loops.scale.ticks) {
    const double x = left + loops.scale.Place(tick.value) * kBarWidth;
    svg->Line(x, top + 27, x, top + 30, plot::MarkStroke(1));
    if (!tick.label.empty()) svg->Text(x, top + 41, tick.label, plot::SoftInk(10.5, "middle"));
  }
}

// Entries of the legend from the left, in rows; the colour bar has the right-hand side.
class Legend {
 public:
  Legend(double top, double right, Svg* svg) : top_(top), right_(right), svg_(svg) {}

  void Line(const std::string& label, const Attributes& stroke) {
    Begin(label, 26);
    if (svg_) svg_->Line(x_, y() - 4, x_ + 20, y() - 4, stroke);
    End(label, 26);
  }
  void Dot(const std::string& label) {
    Begin(label, 14);
    PathData dot;
    dot.Dot(x_ + 4, y() - 4);
    if (svg_) svg_->Path(dot, plot::MarkStroke(5));
    End(label, 14);
  }
  void Ring(const std::string& label) {
    Begin(label, 16);
    if (svg_) svg_->Circle(x_ + 5, y() - 4, 4, plot::MarkStroke(1.5));
    End(label, 16);
  }
  double Height() const { return (row_ + 1) * kRowHeight; }

 private:
  double y() const { return top_ + row_ * kRowHeight + 12; }
  void Begin(const std::string& label, double swatch) {
    if (x_ > plot::kGraphMargin && x_ + swatch + plot::TextWidth(label, 11) > right_) {
      x_ = plot::kGraphMargin;
      ++row_;
    }
  }
  void End(const std::string& label, double swatch) {
    if (svg_) svg_->Text(x_ + swatch, y(), label, plot::Ink(11));
    x_ += swatch + plot::TextWidth(label, 11) + 14;
  }

  double top_, right_, x_ = plot::kGraphMargin;
  int row_ = 0;
  Svg* svg_;
};

// Without an svg: only measures.  Returns the legend's height.
double DrawLegend(const GraphDrawing& drawing, double top, Svg* svg) {
  const GraphPlot& graph = drawing.graph;
  const bool has_loops = drawing.loops.count != 0;
  const double bar_left = plot::kGraphWidth - plot::kGraphMargin - kBarWidth - 10;
  Legend legend(top, has_loops ? bar_left - 20 : plot::kGraphWidth - plot::kGraphMargin, svg);
  constexpr std::size_t kMost = 24;
  for (std::size_t i = 0; i < std::min(kMost, graph.groups.size()); ++i)
    legend.Line(plot::Shorten(graph.groups[i], 180, 11), plot::GroupStroke(i, 2.5));
  if (graph.groups.size() > kMost)
    legend.Line("and " + std::to_string(graph.groups.size() - kMost) + " more",
                plot::GroupStroke(kMost, 2.5));
  if (drawing.poses != 0) legend.Ring("start");
  if (!graph.landmarks.empty()) legend.Dot(ReadableCount(graph.landmarks.size()) + " landmarks");
  if (svg && has_loops) DrawColourBar(drawing.loops, bar_left, top, svg);
  return std::max(legend.Height(), has_loops ? 46.0 : 0.0);
}

}  // namespace

std::string DrawGraph(const GraphPlot& graph) {
  const GraphDrawing drawing = plot::PrepareGraph(graph);
  const double margin = plot::kGraphMargin, width = plot::kGraphWidth;
  double top = 10;
  const double title_top = top += graph.title.empty() ? 0 : 18;
  const double subtitle_top = top += graph.subtitle.empty() ? 0 : 18;
  top += 28;
  const double legend_top = top + drawing.panel_height + kStripHeight + 14;
  const double height = legend_top + DrawLegend(drawing, 0, nullptr) + 6;

  Svg svg(width, height, graph.title.empty() ? "factor graph" : graph.title);
  const double room = width - 2 * margin;
  if (!graph.title.empty())
    svg.Text(margin, title_top, plot::Shorten(graph.title, room, 17), plot::Ink(17, {}, true));
  if (!graph.subtitle.empty())
    svg.Text(margin, subtitle_top, plot::Shorten(graph.subtitle, room), plot::SoftInk());
  double left = margin;
  if (!graph.before.empty()) {
    DrawFramedPanel(drawing, graph.before, graph.before_label, left, top, &svg);
    left += drawing.panel_width + margin;
  }
  DrawFramedPanel(drawing, graph.after, graph.after_label, left, top, &svg);
  DrawLegend(drawing, legend_top, &svg);
  return svg.Finish();
}

}  // namespace graticule
