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
  double most = moved(points.laser_x, points.laser_y);
  for (std::size_t i = 0; i < points.hull_x.size(); ++i)
    most = std::max(most, moved(points.hull_x[i], points.hull_y[i]));
  return std::sqrt(most);
}

bool ProjectionErrorExceeds(double limit, const ScanPoints& points,
                            const PlanarPose& world_from_then, const PlanarPose& world_from_now) {
  switch (ProjectionErrorBound(limit, points.reach, world_from_then, world_from_now)) {
    case Bound::kWithin:
      return false;
    case Bound::kBeyond:
      return true;
    case Bound::kOpen:
      break;
  }
  return ProjectionError(points, world_from_then, world_from_now) > limit;
}

double ProjectionErrorAtMost(double reach, const PlanarPose& world_from_then,
                             const PlanarPose& world_from_now) {
  const double turn = std::abs(WrappedAngle(world_from_now.yaw - world_from_then.yaw));
  return std::hypot(world_from_now.x - world_from_then.x, world_from_now.y - world_from_then.y) +
         2 * std::sin(turn / 2) * reach;
}

Bound ProjectionErrorBound(double limit, double reach, const PlanarPose& world_from_then,
                           const PlanarPose& world_from_now) {
  const double dx = world_from_now.x - world_from_then.x;
  const double dy = world_from_now.y - world_from_then.y;
  const double shift2 = dx * dx + dy * dy;
  double turn = std::abs(world_from_now.yaw - world_from_then.yaw);
  if (turn > 1) turn = std::abs(WrappedAngle(turn));
  // What is at `reach` moves along a chord, which is a little shorter than the arc.  The factors
  // are for rounding, of the float points too.
  constexpr double kRounding = 1e-6;
  const double arc = turn * reach * (1 + kRounding);
  const double rest = limit * (1 - kRounding) - arc;
  if (rest >= 0 && shift2 <= rest * rest) return Bound::kWithin;
  // The place at `reach` moves by the chord, turned, and the shift: by their difference at least.
  const double chord = turn * reach * (1 - turn * turn / 24) * (1 - kRounding);
  const double beyond = limit * (1 + kRounding);
  if (chord > beyond && shift2 < (chord - beyond) * (chord - beyond)) return Bound::kBeyond;
  if (shift2 > (arc + beyond) * (arc + beyond)) return Bound::kBeyond;
  return Bound::kOpen;
}

}  // namespace graticule
