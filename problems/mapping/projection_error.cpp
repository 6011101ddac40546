#include "graticule/problems/mapping/projection_error.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {

double ProjectionError(const ScanPoints& points, const PlanarPose& world_from_then,
                       const PlanarPose& world_from_now) {
  // p moves by (R_now - R_then) p + t_now - t_then.
  const double c = std::cos(world_from_now.yaw) - std::cos(world_from_then.yaw);
  const double s = std::sin(world_from_now.yaw) - std::sin(world_from_then.yaw);
  const double dx = world_from_now.x - world_from_then.x;
  const double dy = world_from_now.y - world_from_then.y;
  const auto moved = [&](double x, double y) {
    const double along = dx + c * x - s * y, across = dy + s * x + c * y;
    return along * along + across * across;
  };
  double farthest = moved(points.laser_x, points.laser_y);
  for (std::size_t i = 0; i < points.Size(); ++i)
    farthest = std::max(farthest, moved(points.x[i], points.y[i]));
  return std::sqrt(farthest);
}

bool ProjectionErrorExceeds(double limit, const ScanPoints& points,
                            const PlanarPose& world_from_then, const PlanarPose& world_from_now) {
  const double shift =
      std::hypot(world_from_now.x - world_from_then.x, world_from_now.y - world_from_then.y);
  // The chord that the place at `reach` moves along; the factor is for rounding, of the float
  // points too.
  constexpr double kRounding = 1e-6;
  const double chord =
      2 * std::abs(std::sin((world_from_now.yaw - world_from_then.yaw) / 2)) * points.reach;
  if ((shift + chord) * (1 + kRounding) <= limit) return false;
  if (std::abs(chord - shift) * (1 - kRounding) > limit) return true;
  return ProjectionError(points, world_from_then, world_from_now) > limit;
}

}  // namespace graticule
