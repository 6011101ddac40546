#pragma once

#include <vector>

#include "arrays.hpp"
#include "graticule/io/detections.hpp"

namespace graticule::python {

/// Corners as arrays: ids (n,), places on the target (n, 3) [m], pixels (n, 2).
struct CornerArrays {
  py::array_t<int> ids;
  py::array_t<double> in_target, pixels;
};
CornerArrays ArraysOf(const std::vector<DetectedCorner>& corners);
std::vector<DetectedCorner> CornersOf(const Dense<std::int64_t>& ids,
                                      const Dense<double>& in_target, const Dense<double>& pixels);

}  // namespace graticule::python
