#include "graticule/problems/mapping/scan_match.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "graticule/problems/mapping/point_refine.hpp"
#include "graticule/problems/random.hpp"
#include "ring.hpp"

namespace graticule {
namespace {

std::vector<SurfacePoint> RandomPoints(std::uint64_t seed, int count, double extent) {
  RandomNumbers random(seed);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i)
    points.push_back({static_cast<float>(random.Uniform(-extent, extent)),
                      static_cast<float>(random.Uniform(-extent, extent)), 0, 0});
  return points;
}

std::vector<SurfacePoint> PointsAt(double x, double y, double yaw) {
  LaserLog log;
  log.geometries.push_back({-M_PI / 2, M_PI / 180, 79, PlanarPose{}});
  LaserScan scan;
  scan.beams = 181;
  for (int beam = 0; beam < 181; ++beam)
    log.ranges.push_back(static_cast<float>(
        test::Range(test::Building(), x, y, yaw - M_PI / 2 + beam * M_PI / 180)));
  return SurfacePoints(log, scan);
}

TEST(LikelihoodGrid, LevelsBoundEveryCellOfTheirBlock) {
  LikelihoodGrid grid(0.1, 0.1);
  grid.Build(RandomPoints(1, 60, 4), 0, 0, 10);
  RandomNumbers random(2);
  for (int trial = 0; trial < 20000; ++trial) {
    const int level = static_cast<int>(random.Below(LikelihoodGrid::kTopLevel)) + 1;
    // Blocks begin anywhere, also before the grid.
    const int x = static_cast<int>(random.Below(170)) - 40,
              y = static_cast<int>(random.Below(170)) - 40;
    const int dx = static_cast<int>(random.Below(1u << level)),
              dy = static_cast<int>(random.Below(1u << level));
    ASSERT_GE(grid.At(level, x >> level, y >> level), grid.At(0, x + dx, y + dy))
        << level << " " << x << " " << y;
  }
}

TEST(LikelihoodGrid, IsFullAtAPointAndNothingFarFromAll) {
  LikelihoodGrid grid(0.05, 0.07);
  const std::vector<SurfacePoint> points = {{1.23f, -0.4f, 0, 0}, {1000, 0, 0, 0}};
  grid.Build(points, 0, 0, 20);
  const auto cell = [&](double x, double y) {
    return grid.At(0, static_cast<int>((x - grid.OriginX()) / grid.Cell()),
                   static_cast<int>((y - grid.OriginY()) / grid.Cell()));
  };
  EXPECT_EQ(cell(1.231, -0.399), 255);
  EXPECT_LT(cell(1.33, -0.4), 255);
  EXPECT_GT(cell(1.33, -0.4), 0);
  EXPECT_EQ(cell(1.8, -0.4), 0);
}

// Against every pose of the window one by one: a search of one pose is its likelihood.
TEST(CorrelativeMatcher, FindsTheBestOfAllPosesOfTheGrid) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    LikelihoodGrid grid(0.1, 0.15);
    const std::vector<SurfacePoint> reference = RandomPoints(seed, 80, 3);
    const std::vector<SurfacePoint> scan = RandomPoints(seed + (seed > 3 ? 0 : 100), 80, 3);
    grid.Build(reference, 0, 0, 10);
    SearchWindow window;
    window.guess = {0.13, -0.2, 0.1};
    window.reach = 0.8;
    window.reach_yaw = 0.2;
    window.sigma = 0.3;
    window.sigma_yaw = 0.1;
    CorrelativeMatcher matcher;
    Match best;
    ASSERT_TRUE(matcher.Search(grid, scan, window, 0, &best));
    const auto value = [&](const Match& match) {
      const PlanarPose& pose = match.reference_from_scan;
      const double x = (pose.x - window.guess.x) / window.sigma,
                   y = (pose.y - window.guess.y) / window.sigma,
                   yaw = (pose.yaw - window.guess.yaw) / window.sigma_yaw;
      return CorrelativeMatcher::kPointWeight * match.score * static_cast<double>(scan.size()) -
             (x * x + y * y + yaw * yaw) / 2;
    };
    double least = -HUGE_VAL;
    const double step = [&] {  // by which the search turns
      double squares = 0;
      for (const SurfacePoint& p : scan)
        squares += static_cast<double>(p.x) * static_cast<double>(p.x) +
                   static_cast<double>(p.y) * static_cast<double>(p.y);
      return 0.1 / (1.5 * std::sqrt(squares / static_cast<double>(scan.size())));
    }();
    const int half_yaw = static_cast<int>(std::ceil(0.2 / step));
    for (int yaw = -half_yaw; yaw <= half_yaw; ++yaw)
      for (int y = -8; y <= 8; ++y)
        for (int x = -8; x <= 8; ++x) {
          SearchWindow one;
          one.guess = {window.guess.x + x * 0.1, window.guess.y + y * 0.1,
                       window.guess.yaw + yaw * step};
          one.reach = one.reach_yaw = 0;
          Match match;
          CorrelativeMatcher single;
          ASSERT_TRUE(single.Search(grid, scan, one, 0, &match));
          least = std::max(least, value(match));
        }
    // Cells are rounded from another corner: a point on a cell's edge may fall to either side.
    EXPECT_NEAR(value(best), least, 0.02 * std::abs(least)) << seed;
  }
}

TEST(CorrelativeMatcher, FindsNothingBelowTheLeastScore) {
  LikelihoodGrid grid(0.05, 0.07);
  grid.Build(RandomPoints(1, 50, 3), 0, 0, 10);
  CorrelativeMatcher matcher;
  Match match;
  EXPECT_FALSE(matcher.Search(grid, RandomPoints(2, 50, 3), SearchWindow(), 0.95, &match));
  EXPECT_FALSE(matcher.Search(grid, Span<const SurfacePoint>(), SearchWindow(), 0, &match));
}

TEST(CorrelativeMatcher, FindsAScanFromAnyHeadingWithinACell) {
  LikelihoodGrid grid(0.05, 0.07);
  grid.Build(PointsAt(1.5, 1.5, 0), 0, 0, 30);
  CorrelativeMatcher matcher;
  SearchWindow window;
  window.reach = 2;
  window.reach_yaw = M_PI;
  Match match;
  ASSERT_TRUE(matcher.Search(grid, PointsAt(2.6, 1.9, 0.4), window, 0.5, &match));
  EXPECT_NEAR(match.reference_from_scan.x, 1.1, 0.06);
  EXPECT_NEAR(match.reference_from_scan.y, 0.4, 0.06);
  EXPECT_NEAR(match.reference_from_scan.yaw, 0.4, 0.02);
}

std::vector<SurfacePoint> Corridor() {
  std::vector<SurfacePoint> points;
  for (float x = -6; x <= 6; x += 0.05f) {
    points.push_back({x, 1, 0, -1});
    points.push_back({x, -1, 0, 1});
  }
  return points;
}

TEST(CorrelativeMatcher, IsUncertainAlongACorridorInTheScansFrame) {
  LikelihoodGrid grid(0.05, 0.07);
  grid.Build(Corridor(), 0, 0, 30);
  std::vector<SurfacePoint> scan;
  for (const SurfacePoint& p : Corridor())
    if (std::abs(p.x) < 4) scan.push_back(p);
  CorrelativeMatcher matcher;
  const std::array<double, 9> ahead = matcher.Covariance(grid, scan, {});
  EXPECT_GT(ahead[0], 20 * ahead[4]);
  std::vector<SurfacePoint> sideways;
  AppendTransformed(scan, {0, 0, -M_PI / 2}, &sideways);
  const std::array<double, 9> turned = matcher.Covariance(grid, sideways, {0, 0, M_PI / 2});
  EXPECT_GT(turned[4], 20 * turned[0]);
}

TEST(RefineOnPoints, EndsFarBelowTheGridsCell) {
  PointIndex index;
  index.Build(PointsAt(1.5, 1.5, 0));
  const Refinement refined = RefineOnPoints(index, PointsAt(1.6, 1.55, 0.05), {0.07, 0.08, 0.03},
                                            {}, Eigen::Matrix3d::Zero(), 1);
  EXPECT_NEAR(refined.reference_from_scan.x, 0.1, 2e-3);
  EXPECT_NEAR(refined.reference_from_scan.y, 0.05, 2e-3);
  EXPECT_NEAR(refined.reference_from_scan.yaw, 0.05, 1e-3);
  EXPECT_GT(refined.matched, 0.85);
}

TEST(RefineOnPoints, StaysWhereThePriorSaysAlongACorridor) {
  PointIndex index;
  index.Build(Corridor());
  const PlanarPose guess{0.2, 0.1, 0.02};
  const Refinement refined =
      RefineOnPoints(index, Corridor(), guess, guess, Eigen::Matrix3d::Identity() * 100, 0.03);
  EXPECT_NEAR(refined.reference_from_scan.x, 0.2, 0.01);
  EXPECT_NEAR(refined.reference_from_scan.y, 0, 0.003);
  EXPECT_LT(refined.information(0, 0), 1e-3 * refined.information(1, 1));
}

TEST(RefineOnPoints, DoesNotMatchTheOtherSideOfAWall) {
  std::vector<SurfacePoint> front, back;
  for (float x = -2; x <= 2; x += 0.05f) {
    front.push_back({x, 0, 0, -1});
    back.push_back({x, 0.1f, 0, 1});
  }
  PointIndex index;
  index.Build(front);
  EXPECT_EQ(RefineOnPoints(index, back, {}, {}, Eigen::Matrix3d::Identity(), 1).points, 0u);
}

}  // namespace
}  // namespace graticule
