#include "graticule/io/chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "graticule/io/plot_style.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

using plot::Attributes;
using plot::Axis;

constexpr double kMargin = 12, kRowHeight = 20;
constexpr std::size_t kMostMarkers = 60;  // a longer curve has none
constexpr std::size_t kDense = 200;       // a longer curve is thin

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool Empty() const { return low > high; }
};

// Beyond these, differences and powers of ten leave the range of a double.
constexpr double kLeast = 1e-300, kMost = 1e300;

bool Usable(double value, bool logarithmic) {
  return std::fabs(value) <= kMost && (!logarithmic || value >= kLeast);
}

// Whether an axis is logarithmic, and its ticks.
Axis MakeAxis(const CurveChart& chart, AxisScale scale, bool is_x, int count) {
  Range all, positive;
  const auto add = [&](double value) {
    if (!Usable(value, false)) return;
    all.Add(value);
    if (Usable(value, true)) positive.Add(value);
  };
  for (const Curve& curve : chart.curves)
    for (const Curve::Point& point : curve.points) add(is_x ? point.x : point.y);
  for (const CurveBand& band : chart.bands)
    for (const CurveBand::Point& point : band.points) {
      add(is_x ? point.x : point.low);
      add(is_x ? point.x : point.high);
    }
  if (all.Empty()) return plot::LinearAxis(0, 1, count);
  const bool wide = all.low > 0 && all.high > 100 * all.low;
  const bool logarithmic = !positive.Empty() && (scale == AxisScale::kLogarithmic ||
                                                 (scale == AxisScale::kAutomatic && wide));
  if (logarithmic) return plot::LogAxis(positive.low, positive.high, count);
  if (!is_x || !chart.whole_x) return plot::LinearAxis(all.low, all.high, count);
  Axis axis = plot::LinearAxis(all.low, std::max(all.high, all.low + 1), count);
  if (axis.ticks.size() > 1 && axis.ticks[1].value - axis.ticks[0].value < 1)
    axis = plot::LinearAxis(all.low, all.low + std::max(1.0, all.high - all.low),
                            static_cast<int>(std::max(1.0, all.high - all.low)));
  axis.high = std::max(all.high, all.low + 1);
  while (axis.ticks.back().value > axis.high) axis.ticks.pop_back();
  return axis;
}

// Swatches with names, in rows from `left` to `right`.  Without an svg: only measures.
double DrawLegend(const std::vector<std::string>& names, bool lines, double left, double right,
                  double top, Svg* svg) {
  double x = left, y = top + 12;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = plot::Shorten(names[i], 260, 11);
    const double width = 26 + plot::TextWidth(name, 11);
    if (x > left && x + width > right) {
      x = left;
      y += kRowHeight;
    }
    if (svg) {
      if (lines)
        svg->Line(x, y - 4, x + 20, y - 4, plot::SeriesStroke(i, 2.5));
      else
        svg->Rect(x + 6, y - 10, 12, 12, plot::SeriesFill(i));
      svg->Text(x + 25, y, name, plot::Ink(11));
    }
    x += width + 14;
  }
  return names.empty() ? 0 : y - top + 8;
}

double DrawTitle(const std::string& title, double width, Svg* svg) {
  if (title.empty()) return 8;
  if (svg)
    svg->Text(kMargin, 22, plot::Shorten(title, width - 2 * kMargin, 14), plot::Ink(14, {}, true));
  return 38;
}

// The rectangle that the curves lie in [px].
struct Area {
  double left, top, right, bottom;
  double X(const Axis& axis, double value) const {
    return left + axis.Place(value) * (right - left);
  }
  double Y(const Axis& axis, double value) const {
    return bottom - axis.Place(value) * (bottom - top);
  }
};

void DrawGrid(const CurveChart& chart, const Area& area, const Axis& x_axis, const Axis& y_axis,
              Svg* svg) {
  svg->Rect(area.left, area.top, area.right - area.left, area.bottom - area.top, plot::Paper());
  for (const plot::Tick& tick : x_axis.ticks) {
    const double x = area.X(x_axis, tick.value);
    svg->Line(x, area.top, x, area.bottom, plot::Grid());
    if (!tick.label.empty())
      svg->Text(x, area.bottom + 16, tick.label, plot::SoftInk(11, "middle"));
  }
  for (const plot::Tick& tick : y_axis.ticks) {
    const double y = area.Y(y_axis, tick.value);
    svg->Line(area.left, y, area.right, y, plot::Grid());
    if (!tick.label.empty()) svg->Text(area.left - 7, y + 4, tick.label, plot::SoftInk(11, "end"));
  }
  svg->Rect(area.left, area.top, area.right - area.left, area.bottom - area.top, plot::Frame());
  svg->Text(0.5 * (area.left + area.right), area.bottom + 36, chart.x_label,
            plot::Ink(11.5, "middle"));
  Attributes turned = plot::Ink(11.5, "middle");
  const double middle = 0.5 * (area.top + area.bottom);
  turned.emplace_back("transform",
                      "rotate(-90 " + SvgNumber(kMargin + 8) + " " + SvgNumber(middle) + ")");
  svg->Text(kMargin + 8, middle, chart.y_label, turned);
}

void DrawCurve(const Curve& curve, std::size_t number, const Area& area, const Axis& x_axis,
               const Axis& y_axis, Svg* svg) {
  PathData line(1);
  bool begun = false;
  for (const Curve::Point& point : curve.points) {
    if (!Usable(point.x, x_axis.logarithmic) || !Usable(point.y, y_axis.logarithmic)) continue;
    const double x = area.X(x_axis, point.x), y = area.Y(y_axis, point.y);
    begun ? line.LineTo(x, y) : line.MoveTo(x, y);
    begun = true;
  }
  Attributes stroke = plot::SeriesStroke(number, curve.points.size() > kDense ? 1.2 : 2);
  stroke.emplace_back("stroke-linejoin", "round");
  if (!curve.dots) svg->Path(line, stroke, curve.name);
  if (Usable(curve.level, y_axis.logarithmic) && curve.level >= y_axis.low &&
      curve.level <= y_axis.high) {
    Attributes dashed = plot::SeriesStroke(number, 1.6);
    dashed.emplace_back("stroke-dasharray", "7 4");
    const double y = area.Y(y_axis, curve.level);
    svg->Line(area.left, y, area.right, y, dashed);
  }
  if (curve.points.size() > kMostMarkers && !curve.dots) return;
  for (const Curve::Point& point : curve.points)
    if (Usable(point.x, x_axis.logarithmic) && Usable(point.y, y_axis.logarithmic))
      svg->Circle(area.X(x_axis, point.x), area.Y(y_axis, point.y),
                  curve.points.size() > 30 ? 2.2 : 3, plot::SeriesFill(number),
                  (curve.name.empty() ? "" : curve.name + ": ") + ReadableNumber(point.x, 6) +
                      ", " + ReadableNumber(point.y, 7));
}

void DrawBand(const CurveBand& band, const Area& area, const Axis& x_axis, const Axis& y_axis,
              Svg* svg) {
  std::vector<CurveBand::Point> points;
  for (const CurveBand::Point& point : band.points)
    if (Usable(point.x, x_axis.logarithmic) && Usable(point.high, y_axis.logarithmic) &&
        Usable(point.low, y_axis.logarithmic))
      points.push_back(point);
  if (points.size() < 2) return;
  PathData outline(1);
  outline.MoveTo(area.X(x_axis, points[0].x), area.Y(y_axis, points[0].low));
  for (const CurveBand::Point& point : points)
    outline.LineTo(area.X(x_axis, point.x), area.Y(y_axis, point.high));
  for (auto point = points.rbegin(); point != points.rend(); ++point)
    outline.LineTo(area.X(x_axis, point->x), area.Y(y_axis, point->low));
  outline.Close();
  Attributes fill = plot::SeriesFill(band.curve);
  fill.emplace_back("fill-opacity", "0.22");
  svg->Path(outline, fill);
}

void DrawGuide(const ChartGuide& guide, const Area& area, const Axis& x_axis, const Axis& y_axis,
               Svg* svg) {
  const Axis& axis = guide.upright ? x_axis : y_axis;
  if (!Usable(guide.at, axis.logarithmic)) return;
  const double place = axis.Place(guide.at);
  if (!(place >= 0 && place <= 1)) return;
  Attributes stroke = plot::MarkStroke(1.2);
  stroke.emplace_back("stroke-dasharray", "4 3");
  if (guide.upright) {
    const double x = area.X(x_axis, guide.at);
    const bool left = x + plot::TextWidth(guide.label, 11) + 8 > area.right;
    svg->Line(x, area.top, x, area.bottom, stroke);
    svg->Text(x + (left ? -5 : 5), area.top + 14, guide.label,
              plot::SoftInk(11, left ? "end" : ""));
  } else {
    const double y = area.Y(y_axis, guide.at);
    svg->Line(area.left, y, area.right, y, stroke);
    svg->Text(area.left + 6, y - 5, guide.label, plot::SoftInk(11));
  }
}

double Clean(double seconds) { return std::isfinite(seconds) && seconds > 0 ? seconds : 0; }

}  // namespace

std::string DrawCurves(const CurveChart& chart) {
  const Axis y_axis = MakeAxis(chart, chart.y_scale, false, 6);
  double label_width = 0;
  for (const plot::Tick& tick : y_axis.ticks)
    label_width = std::max(label_width, plot::TextWidth(tick.label, 11));

  std::vector<std::string> names;
  for (const Curve& curve : chart.curves) names.push_back(curve.name);
  if (names.size() < 2) names.clear();

  const double left = kMargin + 24 + label_width, right = chart.width - kMargin - 8;
  const double title = DrawTitle(chart.title, chart.width, nullptr);
  const double legend = DrawLegend(names, true, left, right, 0, nullptr);
  const Area area{left, title + legend, right, title + legend + chart.height - 90};
  const Axis x_axis = MakeAxis(chart, chart.x_scale, true, static_cast<int>((right - left) / 90));

  Svg svg(chart.width, area.bottom + (chart.note.empty() ? 48 : 66), chart.title);
  DrawTitle(chart.title, chart.width, &svg);
  DrawLegend(names, true, left, right, title, &svg);
  DrawGrid(chart, area, x_axis, y_axis, &svg);
  for (const CurveBand& band : chart.bands) DrawBand(band, area, x_axis, y_axis, &svg);
  for (const ChartGuide& guide : chart.guides) DrawGuide(guide, area, x_axis, y_axis, &svg);
  if (!chart.note.empty())
    svg.Text(kMargin, area.bottom + 56, plot::Shorten(chart.note, chart.width - 2 * kMargin, 11.5),
             plot::SoftInk(11.5));
  for (std::size_t i = 0; i < chart.curves.size(); ++i)
    DrawCurve(chart.curves[i], i, area, x_axis, y_axis, &svg);
  return svg.Finish();
}

std::string DrawBars(const BarChart& chart) {
  constexpr double kBarHeight = 18, kBarStep = 27, kSumWidth = 84;
  double longest = 0, name_width = 0;
  for (const BarChart::Bar& bar : chart.bars) {
    double sum = 0;
    for (const double part : bar.seconds) sum += Clean(part);
    longest = std::max(longest, sum);
    name_width = std::max(name_width, plot::TextWidth(bar.name));
  }
  // Labels in the unit that fits the longest bar.
  const bool in_ms = longest < 1;
  const double unit = in_ms ? 1e-3 : 1;
  const Axis axis = plot::LinearAxis(0, longest > 0 ? longest / unit : 1, 6);

  const double left = kMargin + std::min(name_width, 0.35 * chart.width) + 8;
  const double right = chart.width - kMargin - kSumWidth;
  const double title = DrawTitle(chart.title, chart.width, nullptr);
  const double legend = DrawLegend(chart.parts, false, kMargin, chart.width - kMargin, 0, nullptr);
  const double top = title + legend + 4;
  const double bottom = top + kBarStep * static_cast<double>(chart.bars.size()) + 4;

  Svg svg(chart.width, bottom + 44, chart.title);
  DrawTitle(chart.title, chart.width, &svg);
  DrawLegend(chart.parts, false, kMargin, chart.width - kMargin, title, &svg);
  for (const plot::Tick& tick : axis.ticks) {
    const double x = left + axis.Place(tick.value) * (right - left);
    svg.Line(x, top, x, bottom, plot::Grid());
    svg.Text(x, bottom + 15, tick.label, plot::SoftInk(11, "middle"));
  }
  svg.Text(0.5 * (left + right), bottom + 34, in_ms ? "time [ms]" : "time [s]",
           plot::Ink(11.5, "middle"));
  double y = top + 6;
  for (const BarChart::Bar& bar : chart.bars) {
    svg.Text(left - 8, y + 13, plot::Shorten(bar.name, left - kMargin - 8), plot::Ink(12, "end"));
    double sum = 0;
    for (std::size_t part = 0; part < bar.seconds.size(); ++part) {
      const double from = axis.Place(sum / unit);
      sum += Clean(bar.seconds[part]);
      const double width = (axis.Place(sum / unit) - from) * (right - left);
      if (width < 0.05) continue;
      svg.Rect(left + from * (right - left), y, width, kBarHeight, plot::SeriesFill(part),
               (part < chart.parts.size() ? chart.parts[part] + ": " : "") +
                   ReadableSeconds(bar.seconds[part]));
    }
    svg.Text(left + axis.Place(sum / unit) * (right - left) + 6, y + 13, ReadableSeconds(sum),
             plot::Ink(11));
    y += kBarStep;
  }
  return svg.Finish();
}

}  // namespace graticule
