#include "graticule/problems/mapping/scan_points.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {

ScanPoints ScanReader::Read(const LaserGeometry& geometry, Span<const float> ranges) {
  const PlanarPose& laser = geometry.robot_from_laser;
  for (const double number :
       {geometry.first_angle, geometry.step, geometry.max_range, laser.x, laser.y, laser.yaw})
    if (!std::isfinite(number)) throw Error("the laser's geometry is not finite");
  if (cosine_.size() < ranges.size() || geometry.first_angle != geometry_.first_angle ||
      geometry.step != geometry_.step || laser.yaw != geometry_.robot_from_laser.yaw) {
    geometry_ = geometry;
    cosine_.resize(ranges.size());
    sine_.resize(ranges.size());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double angle =
          laser.yaw + geometry.first_angle + static_cast<double>(i) * geometry.step;
      cosine_[i] = std::cos(angle);
      sine_[i] = std::sin(angle);
    }
  }

  ScanPoints points;
  points.laser_x = static_cast<float>(laser.x);
  points.laser_y = static_cast<float>(laser.y);
  points.x.reserve(ranges.size());
  points.y.reserve(ranges.size());
  points.hit.reserve(ranges.size());
  double reach2 = laser.x * laser.x + laser.y * laser.y;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    double range = ranges[i];
    if (!(range > 0) || std::isinf(range)) continue;
    const bool returned = range < geometry.max_range;
    if (!returned && !use_.clear_no_return) continue;
    const bool hit = returned && range <= use_.max_range;
    range = std::min(range, use_.max_range);
    const double x = laser.x + range * cosine_[i], y = laser.y + range * sine_[i];
    points.x.push_back(static_cast<float>(x));
    points.y.push_back(static_cast<float>(y));
    points.hit.push_back(hit);
    reach2 = std::max(reach2, x * x + y * y);
  }
  points.reach = std::sqrt(reach2);
  return points;
}

}  // namespace graticule
