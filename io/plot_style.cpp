#include "graticule/io/plot_style.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graticule/io/readable.hpp"

namespace graticule {
namespace plot {
namespace {

struct Colour {
  const char* light;
  const char* dark;
};

enum Name : std::size_t { kBlue, kGreen, kPink, kSky, kGrey, kOlive, kVermilion, kOrange, kPale };

constexpr Colour kColours[] = {
    {"#0072b2", "#4aa3e0"}, {"#009e73", "#2cc79b"}, {"#cc79a7", "#e39cc3"},
    {"#56b4e9", "#9ad5f7"}, {"#5b5f66", "#b4bac4"}, {"#7d6a00", "#c2ac3a"},
    {"#d55e00", "#f2833a"}, {"#e69f00", "#f3bc45"}, {"#b9bfc8", "#59606b"}};
constexpr std::size_t kSeries[] = {kBlue, kVermilion, kGreen, kOrange, kPink,
                                   kSky,  kGrey,      kOlive, kPale};
constexpr std::size_t kGroups[] = {kBlue, kGreen, kSky, kOlive, kPink};

// Inferno (Smith, van der Walt; CC0), which rises evenly in lightness; without the ends that
// vanish on white or on black.
constexpr Colour kRamp[kRampSteps] = {
    {"#f9c932", "#57106e"}, {"#fca50a", "#781c6d"}, {"#f37819", "#932667"},
    {"#e45a31", "#bc3754"}, {"#cc4248", "#dd513a"}, {"#a92e5e", "#f1731d"},
    {"#85216b", "#fb9b06"}, {"#56106e", "#f9c932"}, {"#280b53", "#f6f07a"}};

constexpr Colour kInk = {"#1c2026", "#e6e8eb"};
constexpr Colour kSoft = {"#5d6570", "#a2a9b3"};
constexpr Colour kPaper = {"#ffffff", "#14171c"};
constexpr Colour kFrame = {"#b9bfc8", "#444b55"};
constexpr Colour kGrid = {"#e4e7eb", "#2a3038"};

std::string Indexed(const char* prefix, std::size_t index) {
  return prefix + std::to_string(index);
}

Attributes Text(const Colour& colour, const char* css, double size, std::string_view anchor) {
  return {{"class", css},
          {"fill", colour.light},
          {"font-size", SvgNumber(size)},
          {"text-anchor", std::string(anchor)}};
}

Attributes Stroke(const std::string& css, const Colour& colour, double width) {
  return {{"class", css},
          {"stroke", colour.light},
          {"stroke-width", SvgNumber(width)},
          {"fill", "none"}};
}

}  // namespace

Attributes SeriesStroke(std::size_t series, double width) {
  const std::size_t colour = kSeries[series % std::size(kSeries)];
  Attributes attributes = Stroke(Indexed("ps", colour), kColours[colour], width);
  if (series >= std::size(kSeries)) attributes.emplace_back("stroke-dasharray", "5 3");
  return attributes;
}

Attributes SeriesFill(std::size_t series) {
  const std::size_t colour = kSeries[series % std::size(kSeries)];
  return {{"class", Indexed("pf", colour)}, {"fill", kColours[colour].light}};
}

Attributes GroupStroke(std::size_t group, double width) {
  static constexpr const char* kDashes[] = {"", "5 2.5", "1.5 2.5", "8 2 1.5 2"};
  const std::size_t colour = kGroups[group % std::size(kGroups)];
  Attributes attributes = Stroke(Indexed("ps", colour), kColours[colour], width);
  attributes.emplace_back("stroke-dasharray",
                          kDashes[group / std::size(kGroups) % std::size(kDashes)]);
  return attributes;
}

Attributes MarkStroke(double width) {
  Attributes attributes = Stroke(Indexed("ps", kGrey), kColours[kGrey], width);
  attributes.emplace_back("stroke-linecap", "round");
  return attributes;
}

Attributes RampStroke(std::size_t step, double width) {
  return Stroke(Indexed("pr", step), kRamp[step], width);
}

Attributes RampFill(std::size_t step) {
  return {{"class", Indexed("pq", step)}, {"fill", kRamp[step].light}};
}

Attributes Ink(double size, std::string_view anchor, bool bold) {
  Attributes attributes = Text(kInk, "pink", size, anchor);
  if (bold) attributes.emplace_back("font-weight", "bold");
  return attributes;
}

Attributes SoftInk(double size, std::string_view anchor) {
  return Text(kSoft, "psoft", size, anchor);
}

Attributes Paper() {
  return {{"class", "ppaper"}, {"fill", kPaper.light}, {"stroke", kFrame.light}};
}

Attributes Grid() { return {{"class", "pgrid"}, {"stroke", kGrid.light}, {"fill", "none"}}; }

Attributes Frame() { return {{"class", "pframe"}, {"stroke", kFrame.light}, {"fill", "none"}}; }

double TextWidth(std::string_view text, double size) {
  return 0.64 * size * static_cast<double>(DisplayWidth(text));
}

std::string Shorten(std::string_view text, double width, double size) {
  if (TextWidth(text, size) <= width) return std::string(text);
  const auto continues = [&](std::size_t i) {
    return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80;
  };
  std::size_t length = text.size();
  while (length > 0 && TextWidth(text.substr(0, length), size) + size > width) do
      --length;
    while (length > 0 && continues(length));
  return std::string(text.substr(0, length)) + "…";
}

double Axis::Place(double value) const {
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

double RoundDown(double value) {
  const double power = std::pow(10, std::floor(std::log10(value) + 1e-9));
  const double lead = value / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

Axis LinearAxis(double low, double high, int count) {
  if (!(high - low > 1e-12 * std::max(std::fabs(low), std::fabs(high)))) {
    const double margin = std::max(std::fabs(low) * 0.1, 1e-12);
    low -= margin;
    high += margin;
  }
  Axis axis;
  double step = RoundDown((high - low) / count);
  while ((high - low) / step > count * 1.5) step = RoundDown(step * 2.5);
  axis.low = std::floor(low / step + 1e-9) * step;
  axis.high = std::ceil(high / step - 1e-9) * step;
  const auto steps = std::llround((axis.high - axis.low) / step);
  // Neighbouring labels must differ: as many digits as the step asks for.
  const double size = std::max(std::fabs(axis.low), std::fabs(axis.high));
  const int digits = std::max(2, static_cast<int>(std::ceil(std::log10(size / step) - 1e-9)) + 1);
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const bool plain = (size < 1e7 && step > 1e-5) || digits > 6;
  for (long long i = 0; i <= steps; ++i) {
    double value = axis.low + static_cast<double>(i) * step;
    if (std::fabs(value) < step * 1e-6) value = 0;
    axis.ticks.push_back(
        {value, plain ? fmt::format("{:.{}f}", value, decimals) : ReadableNumber(value, digits)});
  }
  return axis;
}

Axis LogAxis(double low, double high, int count) {
  Axis axis;
  axis.logarithmic = true;
  if (!(high > low * 1.0001)) {
    low *= 0.5;
    high *= 2;
  }
  const bool narrow = std::log10(high / low) < 2;
  int first = static_cast<int>(std::floor(std::log10(low) + 1e-9));
  int last = static_cast<int>(std::ceil(std::log10(high) - 1e-9));
  if (last == first) ++last;
  axis.low = RoundDown(low * 1.000001);
  axis.high = RoundDown(high * 1.000001);
  if (axis.high < high * 0.9999) axis.high = RoundDown(axis.high * 2.500001);
  const int every = std::max(1, (last - first + count - 1) / count);
  for (int exponent = first; exponent <= last; ++exponent)
    for (const int lead : {1, 2, 5}) {
      const double value = lead * std::pow(10, exponent);
      if (value < axis.low * 0.9999 || value > axis.high * 1.0001) continue;
      if (lead != 1 && !narrow) continue;
      const bool labelled = narrow || (exponent - first) % every == 0;
      axis.ticks.push_back({value, labelled ? ReadableNumber(value, 2) : std::string()});
    }
  return axis;
}

void DrawScaleBar(double pixels_per_metre, double width, double left, double top, Svg* svg) {
  const double metres = RoundDown(width * 0.25 / pixels_per_metre);
  const double right = left + metres * pixels_per_metre;
  const Attributes stroke = MarkStroke(1.5);
  svg->Line(left, top, right, top, stroke);
  svg->Line(left, top - 4, left, top + 4, stroke);
  svg->Line(right, top - 4, right, top + 4, stroke);
  svg->Text(right + 7, top + 4, ReadableNumber(metres) + " m", SoftInk(11));
}

}  // namespace plot

std::string PlotDarkCss() {
  // A ring has the classes of the paper and of a series: the later rule wins.
  std::string css =
      fmt::format(".ppaper{{fill:{};stroke:{}}}", plot::kPaper.dark, plot::kFrame.dark);
  const auto rule = [&](const char* property, const std::string& name, const char* colour) {
    css += fmt::format(".{}{{{}:{}}}", name, property, colour);
  };
  for (std::size_t i = 0; i < std::size(plot::kColours); ++i) {
    rule("stroke", plot::Indexed("ps", i), plot::kColours[i].dark);
    rule("fill", plot::Indexed("pf", i), plot::kColours[i].dark);
  }
  for (std::size_t i = 0; i < plot::kRampSteps; ++i) {
    rule("stroke", plot::Indexed("pr", i), plot::kRamp[i].dark);
    rule("fill", plot::Indexed("pq", i), plot::kRamp[i].dark);
  }
  rule("fill", "pink", plot::kInk.dark);
  rule("fill", "psoft", plot::kSoft.dark);
  rule("stroke", "pgrid", plot::kGrid.dark);
  rule("stroke", "pframe", plot::kFrame.dark);
  return css;
}

}  // namespace graticule
