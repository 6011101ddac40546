#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace graticule {

/// A line of a chart.  Points that are not finite are left out.
struct Curve {
  struct Point {
    double x = 0, y = 0;
  };
  std::string name;
  std::vector<Point> points;
  /// Drawn across the chart, dashed, where it is finite: the curve's mean.
  double level = std::numeric_limits<double>::quiet_NaN();
  bool dots = false;  ///< points only, no line between them
};

/// What lies around a curve: its uncertainty.
struct CurveBand {
  struct Point {
    double x = 0, low = 0, high = 0;
  };
  std::size_t curve = 0;  ///< whose colour it has
  std::vector<Point> points;
};

/// A dashed line across a chart, with a label; left out where it is outside of the axes.
struct ChartGuide {
  bool upright = true;
  double at = 0;
  std::string label;
};

enum class AxisScale {
  kAutomatic,  ///< logarithmic where all values are above 0 and span more than a factor of 100
  kLinear,
  kLogarithmic,  ///< values that are not above 0 are left out
};

struct CurveChart {
  std::string title;
  std::string x_label, y_label;  ///< with their units: "time [s]"
  AxisScale x_scale = AxisScale::kLinear;
  AxisScale y_scale = AxisScale::kAutomatic;
  bool whole_x = false;  ///< x counts something: ticks at whole numbers only
  std::vector<Curve> curves;
  std::vector<CurveBand> bands;
  std::vector<ChartGuide> guides;
  std::string note;                  ///< a line below
  double width = 760, height = 320;  ///< [px]
};

/// An SVG document with a line for each curve, and a legend where there are several.
std::string DrawCurves(const CurveChart& chart);

/// Horizontal bars, each a stack of parts, in seconds.
struct BarChart {
  struct Bar {
    std::string name;
    std::vector<double> seconds;  ///< one for each part; not finite or negative: 0
  };
  std::string title;
  std::vector<std::string> parts;
  std::vector<Bar> bars;
  double width = 760;  ///< [px]; the height follows from the bars
};

/// An SVG document with a legend of the parts, and each bar's sum beside it.
std::string DrawBars(const BarChart& chart);

}  // namespace graticule
