#pragma once

#include <string>
#include <vector>

#include "graticule/io/image_field.hpp"
#include "graticule/io/plot_style.hpp"

namespace graticule {

/// Where a field is at least as large as a level: closed outlines, to be filled by the even-odd
/// rule.
struct FieldRegion {
  struct Point {
    ImagePoint at;
    /// Not a contour but the edge of the image, or of where there are values.
    bool border = false;
  };
  std::vector<std::vector<Point>> outlines;
};

/// Marching squares between the nodes; in terms of logarithms if asked for, where all values have
/// to be above zero.  Reaches to the image's edge, and half way to a node without value.
FieldRegion RegionAbove(const ImageField& field, double level, bool logarithmic);

/// Round values for filled contours.
struct ContourLevels {
  bool logarithmic = false;
  std::vector<double> values;       ///< in order
  std::vector<std::string> labels;  ///< one a value
  double low = 0, high = 0;         ///< of the field; 0, 0 where it has no values

  /// Step of the ramp for what is above `level` values; 0: below all of them.
  std::size_t RampStep(std::size_t level) const;
};

/// At most plot::kRampSteps - 1 levels between the least and the largest value of a field: 1, 2, 5
/// or decades where the values are above zero and span a factor of five, even steps else.
ContourLevels ChooseLevels(const ImageField& field);

}  // namespace graticule
