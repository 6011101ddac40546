#include "graticule/problems/mapping/surface_points.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

constexpr int kNeighbours = 4;             // to each side, for a normal
constexpr double kNeighbourReach = 0.35;   // m
constexpr double kLargestRoughness = 0.2;  // of the spread across to the spread along
constexpr double kGrazing = 0.05;          // sine of the angle between beam and surface
constexpr double kFilled = 0.1;   // m, from a point of a surface to the next, after filling
constexpr double kWidestGap = 4;  // m, that is filled
constexpr double kOnLine = 0.04;  // m, from the line that readings of one surface are on

struct Point {
  double x, y, range;
  int beam;
};

/// The line through the neighbours of a point.  False where there is none.
bool Normal(const std::vector<Point>& points, std::size_t i, double step, const Point& eye,
            SurfacePoint* to) {
  const Point& centre = points[i];
  // Far away, neighbouring beams are far apart.
  const double reach = std::max(kNeighbourReach, 3.5 * step * centre.range);
  double sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  int count = 0;
  const auto add = [&](const Point& point) {
    const double dx = point.x - centre.x, dy = point.y - centre.y;
    if (dx * dx + dy * dy > reach * reach) return false;
    sx += dx, sy += dy, sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
    ++count;
    return true;
  };
  add(centre);
  for (int side = -1; side <= 1; side += 2)
    for (int k = 1; k <= kNeighbours; ++k) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(i) + side * k;
      if (at < 0 || at >= static_cast<std::ptrdiff_t>(points.size())) break;
      if (!add(points[static_cast<std::size_t>(at)])) break;
    }
  if (count < 3) return false;
  const double n = count;
  const double cxx = sxx / n - sx * sx / n / n, cxy = sxy / n - sx * sy / n / n,
               cyy = syy / n - sy * sy / n / n;
  const double mean = (cxx + cyy) / 2, apart = std::hypot((cxx - cyy) / 2, cxy);
  const double across = std::sqrt(std::max(mean - apart, 0.0)), along = std::sqrt(mean + apart);
  if (along < 1e-3 || across > kLargestRoughness * along) return false;
  const double angle = std::atan2(2 * cxy, cxx - cyy) / 2;  // of the line
  double nx = -std::sin(angle), ny = std::cos(angle);
  const double bx = eye.x - centre.x, by = eye.y - centre.y;
  const double facing = nx * bx + ny * by;
  if (facing < 0) nx = -nx, ny = -ny;
  if (std::abs(facing) < kGrazing * std::hypot(bx, by)) return false;
  to->nx = static_cast<float>(nx);
  to->ny = static_cast<float>(ny);
  return true;
}

std::vector<Point> Readings(const LaserLog& log, const LaserScan& scan,
                            const SurfaceOptions& options) {
  const LaserGeometry& geometry = log.GeometryOf(scan);
  const Span<const float> ranges = log.RangesOf(scan);
  const double far =
      geometry.max_range > 0 ? std::min(geometry.max_range, options.max_range) : options.max_range;
  std::vector<Point> points;
  points.reserve(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double range = static_cast<double>(ranges[i]);
    if (!(range >= options.min_range && range < far)) continue;
    const double angle = geometry.first_angle + geometry.step * static_cast<double>(i);
    Point point{0, 0, range, static_cast<int>(i)};
    geometry.robot_from_laser.Transform(range * std::cos(angle), range * std::sin(angle), &point.x,
                                        &point.y);
    points.push_back(point);
  }
  return points;
}

/// Whether the surface that four readings are of goes on between the two in the middle: they are
/// of beams one after the other, and on a line.
bool GoesOn(const Point* four) {
  if (four[3].beam - four[0].beam != 3) return false;
  double x = 0, y = 0;
  for (int i = 0; i < 4; ++i) x += four[i].x / 4, y += four[i].y / 4;
  double xx = 0, xy = 0, yy = 0;
  for (int i = 0; i < 4; ++i) {
    const double dx = four[i].x - x, dy = four[i].y - y;
    xx += dx * dx, xy += dx * dy, yy += dy * dy;
  }
  const double angle = std::atan2(2 * xy, xx - yy) / 2;
  const double c = std::cos(angle), s = std::sin(angle);
  double last = 0;
  for (int i = 0; i < 4; ++i) {
    const double dx = four[i].x - x, dy = four[i].y - y;
    if (std::abs(c * dy - s * dx) > kOnLine) return false;
    const double along = c * dx + s * dy;
    // They follow each other along it.
    if (i > 1 && (along > last) != (last > c * (four[0].x - x) + s * (four[0].y - y))) return false;
    last = along;
  }
  return true;
}

}  // namespace

std::vector<SurfacePoint> SurfacePoints(const LaserLog& log, const LaserScan& scan,
                                        const SurfaceOptions& options) {
  const LaserGeometry& geometry = log.GeometryOf(scan);
  const std::vector<Point> points = Readings(log, scan, options);
  const Point eye{geometry.robot_from_laser.x, geometry.robot_from_laser.y, 0, 0};
  std::vector<SurfacePoint> surface;
  surface.reserve(points.size());
  double last_x = HUGE_VAL, last_y = HUGE_VAL;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& point = points[i];
    if (std::hypot(point.x - last_x, point.y - last_y) < options.spacing) continue;
    SurfacePoint out;
    out.x = static_cast<float>(point.x);
    out.y = static_cast<float>(point.y);
    Normal(points, i, std::abs(geometry.step), eye, &out);
    surface.push_back(out);
    last_x = point.x, last_y = point.y;
  }
  return surface;
}

std::vector<SurfacePoint> PointsBetween(const LaserLog& log, const LaserScan& scan,
                                        const SurfaceOptions& options) {
  const PlanarPose& laser = log.GeometryOf(scan).robot_from_laser;
  const std::vector<Point> points = Readings(log, scan, options);
  std::vector<SurfacePoint> between;
  for (std::size_t i = 1; i + 2 < points.size(); ++i) {
    const Point &a = points[i], &b = points[i + 1];
    const double dx = b.x - a.x, dy = b.y - a.y, gap = std::hypot(dx, dy);
    if (gap <= kFilled || gap > kWidestGap || !GoesOn(&points[i - 1])) continue;
    double nx = -dy / gap, ny = dx / gap;
    if (nx * (laser.x - a.x) + ny * (laser.y - a.y) < 0) nx = -nx, ny = -ny;
    const int parts = static_cast<int>(std::ceil(gap / kFilled));
    for (int k = 1; k < parts; ++k) {
      const double part = static_cast<double>(k) / parts;
      between.push_back({static_cast<float>(a.x + part * dx), static_cast<float>(a.y + part * dy),
                         static_cast<float>(nx), static_cast<float>(ny)});
    }
  }
  return between;
}

void AppendTransformed(const std::vector<SurfacePoint>& points, const PlanarPose& frame,
                       std::vector<SurfacePoint>* to) {
  const float c = static_cast<float>(std::cos(frame.yaw)),
              s = static_cast<float>(std::sin(frame.yaw));
  const float x = static_cast<float>(frame.x), y = static_cast<float>(frame.y);
  for (const SurfacePoint& p : points)
    to->push_back(
        {x + c * p.x - s * p.y, y + s * p.x + c * p.y, c * p.nx - s * p.ny, s * p.nx + c * p.ny});
}

}  // namespace graticule
