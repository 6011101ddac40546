#include "graticule/io/map_drawing.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/base64.hpp"
#include "graticule/io/plot_style.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

constexpr double kWidth = 1200, kMargin = 16, kTop = 58, kRow = 20;
constexpr double kTallest = 1600, kNarrowest = 560;  // of the panel, of the page
constexpr double kEntryWidth = 190;                  // of the legend, at least
constexpr std::size_t kNamed = 20;                   // trajectories that the legend names

// From metres to pixels of the panel.
struct View {
  const OccupancyGrid& grid;
  double scale;  // pixels a metre

  double X(double x) const { return (x - grid.map_from_grid.x) * scale; }
  double Y(double y) const {
    return (grid.map_from_grid.y + static_cast<double>(grid.height) * grid.resolution - y) * scale;
  }
};

plot::Attributes ClosureStroke() {
  return {
      {"stroke", "#d55e00"}, {"stroke-width", "0.7"}, {"stroke-opacity", "0.55"}, {"fill", "none"}};
}

void DrawLines(const MapDrawing& drawing, const View& view, Svg* svg) {
  PathData closures;
  for (const auto& [a, b] : drawing.closures)
    closures.Segment(view.X(a.x), view.Y(a.y), view.X(b.x), view.Y(b.y));
  if (!closures.Empty()) svg->Path(closures, ClosureStroke());
  for (std::size_t i = 0; i < drawing.trajectories.size(); ++i) {
    PathData path;
    bool begun = false;
    for (const MapDrawing::Point& point : drawing.trajectories[i].points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      begun ? path.LineTo(view.X(point.x), view.Y(point.y))
            : path.MoveTo(view.X(point.x), view.Y(point.y));
      begun = true;
    }
    if (begun) svg->Path(path, plot::GroupStroke(i, 1.2), drawing.trajectories[i].name);
  }
}

}  // namespace

std::string DrawMap(const MapDrawing& drawing) {
  const OccupancyGrid& grid = drawing.grid;
  const double columns = static_cast<double>(std::max<std::size_t>(grid.width, 1));
  const double rows = static_cast<double>(std::max<std::size_t>(grid.height, 1));
  const double pixel = std::min((kWidth - 2 * kMargin) / columns, kTallest / rows);
  const double width = columns * pixel, height = rows * pixel;
  const double page = std::max(width + 2 * kMargin, kNarrowest);
  const double panel_width = page - 2 * kMargin;
  const std::size_t named = std::min(drawing.trajectories.size(), kNamed);
  const std::size_t entries = named + !drawing.closures.empty();
  const auto across = static_cast<std::size_t>(panel_width / kEntryWidth);
  const double legend =
      kRow * static_cast<double>((entries + across - 1) / across) + (entries ? 10 : 0);

  Svg svg(page, kTop + height + 34 + legend + kMargin, drawing.title);
  svg.Rect(0, 0, page, kTop + height + 34 + legend + kMargin,
           {{"fill", "#ffffff"}, {"class", "paper"}});
  svg.Text(kMargin, 26, drawing.title, plot::Ink(17, {}, true));
  svg.Text(kMargin, 46, drawing.subtitle, plot::SoftInk(12));
  svg.Open("svg", {{"x", SvgNumber(kMargin)},
                   {"y", SvgNumber(kTop)},
                   {"width", SvgNumber(width)},
                   {"height", SvgNumber(height)},
                   {"viewBox", "0 0 " + SvgNumber(width) + " " + SvgNumber(height)}});
  if (!grid.cells.empty())
    svg.Element("image", {{"width", SvgNumber(width)},
                          {"height", SvgNumber(height)},
                          {"preserveAspectRatio", "none"},
                          {"style", "image-rendering:pixelated"},
                          {"href", "data:image/png;base64," + Base64(FormatOccupancyPng(grid))}});
  const View view{grid, pixel / grid.resolution};
  DrawLines(drawing, view, &svg);
  svg.Close();
  svg.Rect(kMargin, kTop, width, height, plot::Frame());
  plot::DrawScaleBar(view.scale, width, kMargin + 4, kTop + height + 18, &svg);

  const auto place = [&](std::size_t entry) {
    const double x =
        kMargin + static_cast<double>(entry % across) * panel_width / static_cast<double>(across);
    return std::pair(x, kTop + height + 44 + kRow * static_cast<double>(entry / across));
  };
  const auto name = [&](std::size_t entry, const std::string& text) {
    const auto [x, y] = place(entry);
    svg.Text(x + 26, y + 4, plot::Shorten(text, panel_width / static_cast<double>(across) - 34, 11),
             plot::Ink(11));
  };
  for (std::size_t i = 0; i < named; ++i) {
    const auto [x, y] = place(i);
    svg.Line(x, y, x + 20, y, plot::GroupStroke(i, 2));
    name(i, drawing.trajectories[i].name);
  }
  if (!drawing.closures.empty()) {
    const auto [x, y] = place(named);
    svg.Line(x, y, x + 20, y, ClosureStroke());
    name(named, ReadableCount(drawing.closures.size()) +
                    (drawing.closures.size() == 1 ? " loop closure" : " loop closures"));
  }
  return svg.Finish();
}

}  // namespace graticule
