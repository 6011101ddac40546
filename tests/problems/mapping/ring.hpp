#pragma once

// A little building, and robots with a laser and bad wheels that drive through it.

#include <cmath>
#include <string>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/problems/random.hpp"

namespace graticule::test {

struct Wall {
  double x0, y0, x1, y1;
};

/// A ring of corridors, 20 m by 14 m, with pillars and niches so that no two places look alike.
inline std::vector<Wall> Building() {
  std::vector<Wall> walls;
  const auto box = [&](double x0, double y0, double x1, double y1) {
    walls.push_back({x0, y0, x1, y0});
    walls.push_back({x1, y0, x1, y1});
    walls.push_back({x1, y1, x0, y1});
    walls.push_back({x0, y1, x0, y0});
  };
  box(0, 0, 20, 14);
  box(3, 3, 17, 11);
  box(5, 0, 5.6, 0.5);
  box(11, 2.6, 12.2, 3);
  box(19.4, 6, 20, 7.1);
  box(13, 13.2, 13.4, 14);
  box(8, 11, 9.5, 11.3);
  box(0, 8.5, 0.8, 9);
  box(0, 4, 0.3, 5.5);
  return walls;
}

inline double Range(const std::vector<Wall>& walls, double x, double y, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  double nearest = 80;
  for (const Wall& wall : walls) {
    const double ex = wall.x1 - wall.x0, ey = wall.y1 - wall.y0;
    const double cross = c * ey - s * ex;
    if (std::abs(cross) < 1e-12) continue;
    const double range = ((wall.x0 - x) * ey - (wall.y0 - y) * ex) / cross;
    const double along = ((wall.x0 - x) * s - (wall.y0 - y) * c) / cross;
    if (range > 0 && along >= 0 && along <= 1) nearest = std::min(nearest, range);
  }
  return nearest;
}

/// `rounds` of the ring from a start (as a part of the ring, 0 to 1), counter-clockwise.  The truth
/// of scan i is appended to `truth`.
inline void Drive(double start, double rounds, std::uint64_t seed, LaserLog* log,
                  std::vector<PlanarPose>* truth) {
  const std::vector<Wall> walls = Building();
  const PlanarPose corners[] = {{1.5, 1.5, 0}, {18.5, 1.5, 0}, {18.5, 12.5, 0}, {1.5, 12.5, 0}};
  constexpr double kStep = 0.1, kTurn = 0.1;
  std::vector<PlanarPose> way;
  for (int side = 0; side < 4; ++side) {
    const PlanarPose& a = corners[side];
    const PlanarPose& b = corners[(side + 1) % 4];
    const double length = std::hypot(b.x - a.x, b.y - a.y), yaw = std::atan2(b.y - a.y, b.x - a.x);
    for (double s = 0; s < length; s += kStep)
      way.push_back({a.x + (b.x - a.x) * s / length, a.y + (b.y - a.y) * s / length, yaw});
    for (double turn = 0; turn < M_PI / 2; turn += kTurn)
      way.push_back({b.x, b.y, WrappedAngle(yaw + turn)});
  }
  if (log->geometries.empty()) log->geometries.push_back({-M_PI / 2, M_PI / 180, 79, PlanarPose{}});
  const auto robot = static_cast<std::uint32_t>(log->robots.size());
  log->robots.push_back("robot" + std::to_string(robot + 1));
  RandomNumbers random(seed);
  PlanarPose odometry;
  const auto first = static_cast<std::size_t>(start * static_cast<double>(way.size()));
  const auto count = static_cast<std::size_t>(rounds * static_cast<double>(way.size()));
  for (std::size_t i = 0; i <= count; ++i) {
    const PlanarPose& pose = way[(first + i) % way.size()];
    if (i > 0) {
      PlanarPose step = Inverse(way[(first + i - 1) % way.size()]) * pose;
      // A wheel that is too large, and slip.
      step.yaw += 0.01 * step.x + 0.05 * step.yaw + 0.002 * random.Normal();
      step.x *= 1.03;
      odometry = odometry * step;
    }
    LaserScan scan;
    scan.time = 0.2 * static_cast<double>(i);
    scan.robot = robot;
    scan.odom_from_robot = odometry;
    scan.first_range = log->ranges.size();
    scan.beams = 181;
    for (int beam = 0; beam < 181; ++beam)
      log->ranges.push_back(
          static_cast<float>(Range(walls, pose.x, pose.y, pose.yaw - M_PI / 2 + beam * M_PI / 180) +
                             0.01 * random.Normal()));
    log->scans.push_back(scan);
    truth->push_back(pose);
  }
}

}  // namespace graticule::test
