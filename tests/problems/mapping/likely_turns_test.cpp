#include "graticule/problems/mapping/likely_turns.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace graticule {
namespace {

// The walls of a room of 8 x 3 m, seen from inside, turned; with a piece of a round wall beside.
std::vector<SurfacePoint> Walls(double turn, double arc = 0) {
  std::vector<SurfacePoint> points;
  const auto add = [&](double x, double y, double nx, double ny) {
    SurfacePoint point;
    point.x = static_cast<float>(x), point.y = static_cast<float>(y);
    point.nx = static_cast<float>(nx), point.ny = static_cast<float>(ny);
    points.push_back(point);
  };
  for (double x = 0; x < 8; x += 0.05) add(x, 0, 0, 1), add(x, 3, 0, -1);
  for (double y = 0; y < 3; y += 0.05) add(0, y, 1, 0), add(8, y, -1, 0);
  for (double a = 0; a < arc; a += 0.01)
    add(4 + std::cos(a), std::sin(a), std::cos(a), std::sin(a));
  std::vector<SurfacePoint> turned;
  AppendTransformed(points, {1, -2, turn}, &turned);
  return turned;
}

bool Has(const std::vector<TurnRange>& ranges, double turn) {
  for (const TurnRange& range : ranges)
    if (std::abs(std::remainder(turn - range.centre, 2 * M_PI)) <= range.half + 1e-9) return true;
  return false;
}

double Width(const std::vector<TurnRange>& ranges) {
  double width = 0;
  for (const TurnRange& range : ranges) width += 2 * range.half;
  return width;
}

TEST(LikelyTurns, AreFewAmongWallsAtRightAngles) {
  for (double turn = -3.1; turn < 3.2; turn += 0.07) {
    const std::vector<TurnRange> ranges = LikelyTurns(Walls(turn), Walls(0, 0.5));
    EXPECT_TRUE(Has(ranges, turn)) << turn;
    EXPECT_LT(Width(ranges), 0.25 * 2 * M_PI) << turn;
  }
}

TEST(LikelyTurns, AreAllWhereNothingHasADirection) {
  std::vector<SurfacePoint> bushes = Walls(0);
  for (SurfacePoint& point : bushes) point.nx = point.ny = 0;
  EXPECT_NEAR(Width(LikelyTurns(bushes, Walls(0))), 2 * M_PI, 1e-9);
  EXPECT_NEAR(Width(LikelyTurns({}, {})), 2 * M_PI, 1e-9);
  std::vector<SurfacePoint> pillar;
  for (double a = 0; a < 2 * M_PI; a += 0.01)
    pillar.push_back({static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)),
                      static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a))});
  EXPECT_NEAR(Width(LikelyTurns(pillar, Walls(0.3))), 2 * M_PI, 1e-9);
}

}  // namespace
}  // namespace graticule
