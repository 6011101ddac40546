#include "graticule/problems/mapping/scan_points.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Vector {
  double x, y;
};

double Cross(const Vector& a, const Vector& b) { return a.x * b.y - a.y * b.x; }

// Whether a place is in the triangle of two others and the origin.  Not of a triangle so slim that
// rounding would decide.
bool Encloses(const Vector& a, const Vector& b, const Vector& inner) {
  constexpr double kLeastAngle = 1e-6;
  const double area = Cross(a, b), turn = area > 0 ? 1 : -1;
  return turn * Cross({b.x - a.x, b.y - a.y}, {inner.x - a.x, inner.y - a.y}) >= 0 &&
         turn * Cross(a, inner) >= 0 && turn * Cross(inner, b) >= 0 &&
         area * area >
             kLeastAngle * kLeastAngle * (a.x * a.x + a.y * a.y) * (b.x * b.x + b.y * b.y);
}

// In one round: the ends are in the order of their angles.
void FindHull(ScanPoints* points) {
  struct Corner {
    Vector seen;  // from the laser
    std::size_t i;
  };
  std::vector<Corner> hull(points->Size());
  std::size_t size = 0;
  for (std::size_t i = 0; i < points->Size(); ++i) {
    const Vector seen{points->x[i] - points->laser_x, points->y[i] - points->laser_y};
    while (size > 1 && Encloses(hull[size - 2].seen, seen, hull[size - 1].seen)) --size;
    hull[size++] = {seen, i};
  }
  points->hull_x.resize(size);
  points->hull_y.resize(size);
  for (std::size_t k = 0; k < size; ++k) {
    points->hull_x[k] = points->x[hull[k].i];
    points->hull_y[k] = points->y[hull[k].i];
  }
}

}  // namespace

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
    const bool returned = !(geometry.max_range > 0) || range < geometry.max_range;
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
  FindHull(&points);
  return points;
}

}  // namespace graticule
