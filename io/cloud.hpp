#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace graticule {

/// Red, green, blue.
using Rgb = std::array<std::uint8_t, 3>;

/// What a point has as position where there was no return.
inline const Eigen::Vector3f kNoReturn =
    Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

/// Points of a scan, row by row, with colours and labels where there are some: each of the lists is
/// empty or has one entry a point.
///
/// Organised: a row is a scan of a sweep, a beam of a rotating LIDAR, or a line of a picture, and
/// neighbours in the grid are neighbours in direction.
struct PointCloud {
  std::size_t width = 0;                   ///< points a row
  std::size_t height = 1;                  ///< rows; 1: not organised
  std::vector<Eigen::Vector3f> in_sensor;  ///< [m]; NaN where there was no return
  std::vector<Rgb> colours;
  std::vector<float> intensities;
  std::vector<std::uint32_t> labels;  ///< 0: none
  /// Rows are beams of a LIDAR that turns all around: the last column is beside the first.
  bool is_spinning = false;

  std::size_t Size() const { return in_sensor.size(); }
  bool IsOrganised() const { return height > 1; }
};

}  // namespace graticule
