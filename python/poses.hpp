#pragma once

#include <vector>

#include "arrays.hpp"

namespace graticule::python {

/// (n, 3) rows of x m, y m, yaw rad.
inline py::array_t<double> RowsOf(const std::vector<PlanarPose>& poses) {
  std::vector<double> rows;
  rows.reserve(3 * poses.size());
  for (const PlanarPose& pose : poses)
    for (const double number : {pose.x, pose.y, pose.yaw}) rows.push_back(number);
  return Owned(std::move(rows), {static_cast<py::ssize_t>(poses.size()), 3});
}

inline std::vector<PlanarPose> PlanarPosesOf(const Dense<double>& rows, const char* what) {
  ExpectShape(rows, {-1, 3}, what);
  std::vector<PlanarPose> poses(static_cast<std::size_t>(rows.shape(0)));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double* row = rows.data(static_cast<py::ssize_t>(i));
    poses[i] = {row[0], row[1], row[2]};
  }
  return poses;
}

}  // namespace graticule::python
