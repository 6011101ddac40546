// Streets: bare walls on both sides, hit far off and slantingly, and others who move there.

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/problems/mapping/scan_track.hpp"
#include "ring.hpp"

namespace graticule {
namespace {

constexpr double kRangeSigma = 0.015;  // m

/// Two walls along x, 7 m apart, longer than anybody sees.
std::vector<test::Wall> Street() { return {{-100, 0, 200, 0}, {-100, 7, 200, 7}}; }

void AddDisc(double x, double y, double radius, std::vector<test::Wall>* walls) {
  constexpr int kSides = 16;
  for (int i = 0; i < kSides; ++i) {
    const double a = 2 * M_PI * i / kSides, b = 2 * M_PI * (i + 1) / kSides;
    walls->push_back({x + radius * std::cos(a), y + radius * std::sin(a), x + radius * std::cos(b),
                      y + radius * std::sin(b)});
  }
}

void Scan(const std::vector<test::Wall>& walls, const PlanarPose& pose, RandomNumbers* random,
          LaserLog* log) {
  if (log->geometries.empty()) {
    log->robots = {"robot1"};
    log->geometries.push_back({-M_PI / 2, M_PI / 180, 30, PlanarPose{}});
  }
  LaserScan scan;
  scan.time = static_cast<double>(log->scans.size());
  scan.odom_from_robot = pose;
  scan.first_range = log->ranges.size();
  scan.beams = 181;
  for (int beam = 0; beam < 181; ++beam) {
    const double range =
        test::Range(walls, pose.x, pose.y, pose.yaw - M_PI / 2 + beam * M_PI / 180);
    log->ranges.push_back(
        static_cast<float>(range < 30 ? range + kRangeSigma * random->Normal() : 30));
  }
  log->scans.push_back(scan);
}

/// The farthest that a scan is off the truth, which is what its wheels say.
double FarthestOff(const LaserLog& log) {
  const Track track = FollowScans(log, 0, {});
  double farthest = 0;
  for (std::size_t i = 0; i < track.scans.size(); ++i) {
    const PlanarPose truth = Inverse(log.scans[0].odom_from_robot) * log.scans[i].odom_from_robot;
    const PlanarPose off = Inverse(truth) * track.scan_poses[i];
    farthest = std::max(farthest, std::hypot(off.x, off.y));
  }
  return farthest;
}

TEST(Street, IsNotMistakenWhereACarDrivesAhead) {
  LaserLog log;
  RandomNumbers random(2);
  for (int i = 0; i < 40; ++i) {
    std::vector<test::Wall> walls = Street();
    walls.push_back({12, 0, 12, 0.5});  // a little to hold on to
    walls.push_back({25, 6.4, 25, 7});
    AddDisc(0.6 * i + 2.5 + 0.2 * i, 3.4, 0.9, &walls);
    AddDisc(30 - 1.2 * i, 5, 0.3, &walls);
    Scan(walls, {0.6 * i, 3, 0}, &random, &log);
  }
  EXPECT_LT(FarthestOff(log), 0.4);
}

TEST(PointsBetween, FillsAWallFarOffAndNoDoorway) {
  LaserLog log;
  RandomNumbers random(3);
  Scan(Street(), {0, 3, 0}, &random, &log);
  const std::vector<SurfacePoint> between = PointsBetween(log, log.scans[0]);
  ASSERT_GT(between.size(), 100u);
  double reach = 0;
  for (const SurfacePoint& p : between) {
    EXPECT_NEAR(std::abs(p.y - 0.5f), 3.5f, 0.1f);
    EXPECT_GT(std::abs(p.ny), 0.95f);
    EXPECT_LT(p.ny * p.y, 0) << "towards the robot";
    reach = std::max(reach, std::abs(static_cast<double>(p.x)));
  }
  EXPECT_GT(reach, 15);

  LaserLog door;
  Scan({{10, -20, 10, -1}, {10, 1, 10, 20}, {14, -20, 14, 20}}, {}, &random, &door);
  for (const SurfacePoint& p : PointsBetween(door, door.scans[0]))
    EXPECT_TRUE(std::abs(p.x - 10) < 0.1f || std::abs(p.x - 14) < 0.1f) << p.x << " " << p.y;
}

}  // namespace
}  // namespace graticule
