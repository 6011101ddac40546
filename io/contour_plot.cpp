#include "graticule/io/contour_plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

PathData Filled(const FieldRegion& region, const ImagePanel& panel) {
  PathData path(1);
  for (const auto& outline : region.outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const double x = panel.X(outline[i].at.x), y = panel.Y(outline[i].at.y);
      i == 0 ? path.MoveTo(x, y) : path.LineTo(x, y);
    }
    if (!outline.empty()) path.Close();
  }
  return path;
}

// The outline without what runs along the border.
PathData Contour(const FieldRegion& region, const ImagePanel& panel) {
  PathData path(1);
  for (const auto& outline : region.outlines) {
    bool begun = false;
    for (std::size_t i = 0; i <= outline.size(); ++i) {
      const FieldRegion::Point& point = outline[i % outline.size()];
      if (point.border) {
        begun = false;
        continue;
      }
      const double x = panel.X(point.at.x), y = panel.Y(point.at.y);
      begun ? path.LineTo(x, y) : path.MoveTo(x, y);
      begun = true;
    }
  }
  return path;
}

}  // namespace

void DrawContours(const ImageField& field, const ContourLevels& levels, const ImagePanel& panel,
                  Svg* svg) {
  plot::Attributes nothing = plot::SeriesFill(8);
  nothing.emplace_back("fill-opacity", "0.35");
  svg->Rect(0, 0, panel.Width(), panel.Height(), nothing);
  const auto fill = [&](double level, std::size_t step, bool logarithmic, const std::string& what) {
    plot::Attributes attributes = plot::RampFill(step);
    attributes.emplace_back("fill-rule", "evenodd");
    svg->Path(Filled(RegionAbove(field, level, logarithmic), panel), attributes, what);
  };
  fill(-std::numeric_limits<double>::infinity(), levels.RampStep(0), false, "");
  for (std::size_t i = 0; i < levels.values.size(); ++i)
    fill(levels.values[i], levels.RampStep(i + 1), levels.logarithmic, "above " + levels.labels[i]);
  for (const double level : levels.values) {
    plot::Attributes line = plot::MarkStroke(0.6);
    line.emplace_back("stroke-opacity", "0.6");
    svg->Path(Contour(RegionAbove(field, level, levels.logarithmic), panel), line);
  }
}

void DrawBoldContour(const ImageField& field, double level, const ImagePanel& panel, Svg* svg) {
  const PathData path = Contour(RegionAbove(field, level, false), panel);
  svg->Path(path, plot::SeriesStroke(0, 2.2), ReadableNumber(level) + " px");
}

void DrawHatching(const FieldRegion& region, const ImagePanel& panel, Svg* svg) {
  constexpr double kStep = 7;  // between lines [px]
  PathData path(1);
  for (double c = kStep; c < panel.Width() + panel.Height(); c += kStep) {
    // Where the line x + y = c crosses the outlines.
    std::vector<double> crossings;
    for (const auto& outline : region.outlines)
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const ImagePoint &a = outline[i].at, &b = outline[(i + 1) % outline.size()].at;
        const double ax = panel.X(a.x), ay = panel.Y(a.y), bx = panel.X(b.x), by = panel.Y(b.y);
        const double da = ax + ay - c, db = bx + by - c;
        if ((da >= 0) == (db >= 0)) continue;
        crossings.push_back(ax + (bx - ax) * da / (da - db));
      }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
      path.Segment(crossings[i], c - crossings[i], crossings[i + 1], c - crossings[i + 1]);
  }
  plot::Attributes stroke = plot::MarkStroke(0.9);
  stroke.emplace_back("stroke-opacity", "0.75");
  svg->Path(path, stroke, "no corner was seen here");
}

void DrawColourBar(const ContourLevels& levels, std::string_view unit, double left, double top,
                   double height, Svg* svg) {
  constexpr double kWidth = 16;
  const std::size_t bands = levels.values.size() + 1;
  const double band = height / static_cast<double>(bands);
  svg->Text(left, top - 7, unit, plot::SoftInk(11));
  const auto tick = [&](double y, const std::string& label, bool soft) {
    svg->Text(left + kWidth + 6, y + 4, label, soft ? plot::SoftInk(10.5) : plot::Ink(11));
  };
  for (std::size_t i = 0; i < bands; ++i) {
    const double y = top + height - static_cast<double>(i + 1) * band;
    svg->Rect(left, y, kWidth, band, plot::RampFill(levels.RampStep(i)));
    if (i + 1 < bands) tick(y, levels.labels[i], false);
  }
  svg->Rect(left, top, kWidth, height, plot::Frame());
  if (band < 14) return;
  tick(top + height, ReadableNumber(levels.low, 2), true);
  tick(top, ReadableNumber(levels.high, 2), true);
}

}  // namespace graticule
