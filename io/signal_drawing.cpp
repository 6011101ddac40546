#include "graticule/io/signal_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "graticule/io/plot_style.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

constexpr double kPanel = 900, kBar = 90, kTitle = 26, kGap = 14;

/// 0 blue, half white, 1 orange.
std::string Colour(double t) {
  static constexpr std::array<std::array<double, 3>, 3> ends = {
      {{28, 78, 158}, {255, 255, 255}, {230, 120, 20}}};
  t = std::clamp(t, 0.0, 1.0) * 2;
  const std::size_t i = t < 1 ? 0 : 1;
  const double f = t - static_cast<double>(i);
  char text[16];
  const auto mix = [&](std::size_t c) {
    return static_cast<int>(std::lround((1 - f) * ends[i][c] + f * ends[i + 1][c]));
  };
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", mix(0), mix(1), mix(2));
  return text;
}

struct Span1 {
  double low, high;
};

/// All but the outermost fiftieths.
Span1 RangeOf(const HeatField& field) {
  std::vector<double> values;
  for (const double value : field.values)
    if (std::isfinite(value)) values.push_back(value);
  if (values.empty()) return {0, 1};
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 50;
  Span1 range{values[cut], values[values.size() - 1 - cut]};
  if (range.high - range.low < 1e-6) range = {range.low - 0.5, range.high + 0.5};
  return range;
}

/// Where a field's panel is, and how it is scaled.
struct Panel {
  double left, top, scale;  // pixels a metre
  double left_m, top_m;
  double X(double x_m) const { return left + (x_m - left_m) * scale; }
  double Y(double y_m) const { return top + (top_m - y_m) * scale; }
};

void DrawStructure(const OccupancyGrid& map, const Panel& panel, double opacity, Svg* svg) {
  // Runs of a row, as lines as wide as a cell.
  PathData path(2);
  const double c = std::cos(map.map_from_grid.yaw), s = std::sin(map.map_from_grid.yaw);
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x) {
      if (map.At(x, y) != Occupancy::kStructure) continue;
      const std::size_t begin = x;
      while (x < map.width && map.At(x, y) == Occupancy::kStructure) ++x;
      const auto place = [&](std::size_t column) {
        const double u = static_cast<double>(column) * map.resolution;
        const double v = (static_cast<double>(y) + 0.5) * map.resolution;
        return std::pair(panel.X(map.map_from_grid.x + c * u - s * v),
                         panel.Y(map.map_from_grid.y + s * u + c * v));
      };
      const auto [x0, y0] = place(begin);
      const auto [x1, y1] = place(x);
      path.Segment(x0, y0, x1, y1);
    }
  if (path.Empty()) return;
  svg->Path(path, {{"stroke", "#000000"},
                   {"stroke-opacity", SvgNumber(opacity)},
                   {"stroke-width", SvgNumber(std::max(0.6, map.resolution * panel.scale))},
                   {"fill", "none"}});
}

void DrawBar(const HeatField& field, const Span1& range, double left, double top, double height,
             Svg* svg) {
  constexpr int kSteps = 48;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps;
    svg->Rect(left, top + height * (1 - (i + 1.0) / kSteps), 16, height / kSteps + 0.6,
              {{"fill", Colour(field.low_is_good ? 1 - t : t)}});
  }
  svg->Rect(left, top, 16, height, {{"fill", "none"}, {"stroke", "#444444"}});
  for (int i = 0; i <= 4; ++i) {
    const double value = range.low + (range.high - range.low) * i / 4;
    char text[32];
    std::snprintf(text, sizeof(text), range.high - range.low < 4 ? "%.2f" : "%.0f", value);
    svg->Text(left + 21, top + height * (1 - i / 4.0) + 4, text, plot::Ink(11));
  }
  svg->Text(left, top - 6, field.unit, plot::SoftInk(11));
}

void DrawField(const HeatField& field, const Span1& range, const Panel& panel, Svg* svg) {
  // Steps of a row that have one colour are one rectangle.
  for (std::size_t y = 0; y < field.height; ++y)
    for (std::size_t x = 0; x < field.width;) {
      const auto colour = [&](std::size_t column) -> std::string {
        const double value = field.values[y * field.width + column];
        if (!std::isfinite(value)) return "#dcdcdc";
        const double t = std::round(64 * (value - range.low) / (range.high - range.low)) / 64;
        return Colour(field.low_is_good ? 1 - t : t);
      };
      const std::string fill = colour(x);
      std::size_t end = x + 1;
      while (end < field.width && colour(end) == fill) ++end;
      const double step = field.step_m * panel.scale;
      svg->Rect(panel.X(field.left_m + static_cast<double>(x) * field.step_m),
                panel.Y(field.bottom_m + static_cast<double>(y + 1) * field.step_m),
                step * static_cast<double>(end - x) + 0.3, step + 0.3, {{"fill", fill}});
      x = end;
    }
}

}  // namespace

std::string DrawHeat(const std::vector<HeatField>& fields, const OccupancyGrid* map,
                     const std::vector<HeatMark>& marks) {
  double height = 0;
  for (const HeatField& field : fields)
    height += kTitle + kGap + 10 +
              kPanel * static_cast<double>(field.height) / static_cast<double>(field.width);
  Svg svg(kPanel + kBar + 2 * kGap, height + kGap, "signal strength");
  double top = 0;
  for (const HeatField& field : fields) {
    top += kTitle;
    svg.Text(kGap, top - 6, field.title, plot::Ink(14, {}, true));
    top += 10;
    const double width_m = static_cast<double>(field.width) * field.step_m;
    const double height_m = static_cast<double>(field.height) * field.step_m;
    const Panel panel{kGap, top, kPanel / width_m, field.left_m, field.bottom_m + height_m};
    const double panel_height = height_m * panel.scale;
    const Span1 range = RangeOf(field);
    DrawField(field, range, panel, &svg);
    if (map != nullptr)
      DrawStructure(*map, panel, field.title.find("structure") == std::string::npos ? 1 : 0.3,
                    &svg);
    for (const HeatMark& mark : marks) {
      svg.Circle(panel.X(mark.x_m), panel.Y(mark.y_m), 5,
                 {{"fill", "#1f9e4a"}, {"stroke", "#ffffff"}});
      svg.Text(panel.X(mark.x_m) + 8, panel.Y(mark.y_m) + 4, mark.name, plot::Ink(12, {}, true));
    }
    svg.Rect(panel.left, panel.top, kPanel, panel_height,
             {{"fill", "none"}, {"stroke", "#444444"}});
    DrawBar(field, range, kGap + kPanel + 14, top + 12, std::max(40.0, panel_height - 24), &svg);
    top += panel_height + kGap;
  }
  return svg.Finish();
}

}  // namespace graticule
