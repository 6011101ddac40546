#pragma once

#include <cstddef>
#include <vector>

namespace graticule {

/// A place in an image [px]; (0, 0) is the centre of the upper left pixel.
struct ImagePoint {
  double x = 0, y = 0;
};

/// A number all over an image, at nodes that are spread evenly from its upper left pixel to its
/// lower right one, both included.
struct ImageField {
  int width = 0, height = 0;          ///< of the image [px]
  std::size_t columns = 0, rows = 0;  ///< of nodes; two at least, each
  std::vector<double> values;         ///< row by row; NaN where there is none

  ImagePoint At(std::size_t column, std::size_t row) const {
    return {static_cast<double>(column) * (width - 1) / static_cast<double>(columns - 1),
            static_cast<double>(row) * (height - 1) / static_cast<double>(rows - 1)};
  }
  double Value(std::size_t column, std::size_t row) const { return values[row * columns + column]; }
};

/// A field without values: about `nodes` of them along the longer side.
inline ImageField EmptyField(int width, int height, std::size_t nodes) {
  ImageField field;
  field.width = width;
  field.height = height;
  const auto along = [&](int side) {
    const int longer = width > height ? width : height;
    const auto count = static_cast<std::size_t>(
        static_cast<double>(nodes - 1) * side / (longer > 0 ? longer : 1) + 1.5);
    return count < 2 ? std::size_t{2} : count;
  };
  field.columns = along(width);
  field.rows = along(height);
  return field;
}

}  // namespace graticule
