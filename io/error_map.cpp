// DrawErrorMap of calibration_pictures.hpp.

#include <cmath>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/contour_plot.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

constexpr double kWidth = 760, kMargin = 12, kBar = 84;

struct Extreme {
  double px = kNotKnown;
  ImagePoint at;
};

Extreme LargestOf(const ErrorMap& map) {
  if (std::isfinite(map.max_px)) return {map.max_px, map.max_at};
  Extreme largest;
  for (std::size_t r = 0; r < map.field.rows; ++r)
    for (std::size_t c = 0; c < map.field.columns; ++c)
      if (const double value = map.field.Value(c, r);
          std::isfinite(value) && !(value <= largest.px))
        largest = {value, map.field.At(c, r)};
  return largest;
}

std::string Pixel(const ImagePoint& at) {
  return "(" + ReadableNumber(std::round(at.x)) + ", " + ReadableNumber(std::round(at.y)) + ")";
}

void DrawMark(const ImagePanel& panel, const Extreme& largest, Svg* svg) {
  const double x = panel.X(largest.at.x), y = panel.Y(largest.at.y);
  plot::Attributes plate = plot::Paper();
  svg->Circle(x, y, 6, plate);
  svg->Circle(x, y, 6, plot::SeriesStroke(0, 2));
  svg->Circle(x, y, 1.8, plot::SeriesFill(0));
  panel.Label(largest.at, "max " + ReadableNumber(largest.px, 3) + " px at " + Pixel(largest.at),
              svg);
}

}  // namespace

std::string DrawErrorMap(const ErrorMap& map) {
  const double title = DrawPictureTitle(map.title, map.subtitle, kWidth, nullptr) + 10;
  const ImagePanel panel(map.field.width, map.field.height, kMargin, title,
                         kWidth - 2 * kMargin - kBar, 560);
  Svg svg(kWidth, panel.Bottom() + 44, map.title);
  DrawPictureTitle(map.title, map.subtitle, kWidth, &svg);

  const ContourLevels levels = ChooseLevels(map.field);
  panel.Open(std::nullopt, &svg);
  DrawContours(map.field, levels, panel, &svg);
  bool unseen = false;
  if (map.seen.size() == map.field.values.size()) {
    ImageField outside = map.field;
    for (std::size_t i = 0; i < map.seen.size(); ++i) {
      if (!std::isnan(outside.values[i])) outside.values[i] = map.seen[i] ? 0 : 1;
      unseen = unseen || outside.values[i] == 1;
    }
    DrawHatching(RegionAbove(outside, 0.5, false), panel, &svg);
  }
  const bool limited = map.limit_px > levels.low && map.limit_px < levels.high;
  if (limited) DrawBoldContour(map.field, map.limit_px, panel, &svg);
  const Extreme largest = LargestOf(map);
  if (std::isfinite(largest.px)) DrawMark(panel, largest, &svg);
  panel.Close(&svg);

  DrawColourBar(levels, "px", panel.Right() + 18, panel.Top() + 12, panel.Height() - 24, &svg);
  std::string note;
  const auto say = [&](const std::string& what) { note += (note.empty() ? "" : "; ") + what; };
  if (std::isfinite(largest.px)) say("largest " + ReadableNumber(largest.px, 3) + " px");
  if (std::isfinite(map.mean_px)) say("mean " + ReadableNumber(map.mean_px, 3) + " px");
  if (limited) say("bold blue: " + ReadableNumber(map.limit_px, 3) + " px, as asked for");
  if (unseen) say("hatched: no corner was seen");
  bool rayless = false;
  for (const double value : map.field.values) rayless = rayless || std::isnan(value);
  if (rayless) say("grey: no ray has its image here");
  svg.Text(kMargin, panel.Bottom() + 22, note, plot::SoftInk(11.5));
  return svg.Finish();
}

}  // namespace graticule
