#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/svg.hpp"

namespace graticule {

/// The one look of all plots.  Colours stand in the SVG as attributes, for white paper; each also
/// carries a class, by which a page in the dark replaces it (PlotDarkCss).
namespace plot {

using Attributes = Svg::Attributes;

constexpr double kFontSize = 12;
/// Steps of the ramp for magnitudes: pale is small, dark is large (reversed in the dark).
constexpr std::size_t kRampSteps = 9;

/// Colours that stay apart for colour-blind eyes (Okabe and Ito 2008), for series of a chart.
Attributes SeriesStroke(std::size_t series, double width);
Attributes SeriesFill(std::size_t series);
/// The same for groups of a graph: none of the ramp's reds and yellows.  Repeats after five
/// colours, with dashes.
Attributes GroupStroke(std::size_t group, double width);
Attributes MarkStroke(double width);  ///< dots that belong to no group
Attributes RampStroke(std::size_t step, double width);
Attributes RampFill(std::size_t step);

Attributes Ink(double size = kFontSize, std::string_view anchor = {}, bool bold = false);
Attributes SoftInk(double size = kFontSize, std::string_view anchor = {});
Attributes Paper();  ///< fill and frame of a panel
Attributes Grid();
Attributes Frame();

/// About the width of a text in pixels, rather too wide than too narrow.
double TextWidth(std::string_view text, double size = kFontSize);
/// The text, cut to this width with an ellipsis.
std::string Shorten(std::string_view text, double width, double size = kFontSize);

/// Where an axis is labelled.
struct Tick {
  double value = 0;
  std::string label;  ///< may be empty: a line of the grid only
};

/// An axis from `low` to `high`, both finite and in order; logarithmic: both above 0.
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<Tick> ticks;

  /// 0 at `low`, 1 at `high`.
  double Place(double value) const;
};

/// An axis around these bounds, with about `count` labels at round numbers.
Axis LinearAxis(double low, double high, int count);
Axis LogAxis(double low, double high, int count);

/// 1, 2 or 5 times a power of ten, at most `value`.
double RoundDown(double value);

/// A line of a round number of metres from (left, top), about a quarter of `width` pixels long, and
/// how long it is.
void DrawScaleBar(double pixels_per_metre, double width, double left, double top, Svg* svg);

}  // namespace plot

/// CSS rules that turn inline plots dark; for inside a prefers-color-scheme query.
std::string PlotDarkCss();

}  // namespace graticule
