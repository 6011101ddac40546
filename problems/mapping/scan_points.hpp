#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/problems/mapping/live_map_options.hpp"

namespace graticule {

/// A sweep's beams that say something, in the robot's frame.
struct ScanPoints {
  float laser_x = 0, laser_y = 0;  ///< m: where the beams begin
  std::vector<float> x, y;         ///< m: where they end, in the order of their angles
  std::vector<std::uint8_t> hit;   ///< whether something was there
  /// m: of the ends, those that the others and the laser enclose left out (but for some).  A turn
  /// and shift moves no place farther than one of the hull, or the laser.
  std::vector<float> hull_x, hull_y;
  double reach = 0;  ///< m, from the robot's origin to the farthest of these places

  std::size_t Size() const { return x.size(); }
};

/// Makes ScanPoints; remembers the directions of the beams of the geometry that it saw last.
class ScanReader {
 public:
  explicit ScanReader(const RangeUse& use) : use_(use) {}

  /// Readings that are NaN, infinite, zero, negative, or at least geometry.max_range ("no return";
  /// 0: not known) say nothing, but see RangeUse.  Throws Error: a geometry that is not finite.
  ScanPoints Read(const LaserGeometry& geometry, Span<const float> ranges);

 private:
  RangeUse use_;
  LaserGeometry geometry_;
  std::vector<double> cosine_, sine_;  // of the beams, in the robot's frame
};

}  // namespace graticule
