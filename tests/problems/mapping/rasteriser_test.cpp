#include "graticule/problems/mapping/rasteriser.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "../../solver/expect_error.hpp"
#include "room.hpp"

namespace graticule {
namespace {

using Cell = std::pair<int, int>;

struct Drawing {
  std::set<Cell> passed, hit;
};

Drawing Draw(const ScanPoints& points, const PlanarPose& pose, double resolution) {
  Rasteriser rasteriser(resolution);
  std::vector<ScanTile> tiles;
  rasteriser.Draw(points, pose, &tiles);
  Drawing drawing;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const ScanTile& tile = tiles[i];
    EXPECT_TRUE(i == 0 || tiles[i - 1].index < tile.index);
    EXPECT_TRUE((tile.passed | tile.hit).Any());
    EXPECT_FALSE((tile.passed & tile.hit).Any());
    const auto collect = [&](const CellBits& bits, std::set<Cell>* cells) {
      ForEachCell(bits, [&](int x, int y) {
        cells->emplace(16 * tile.index.x + x, 16 * tile.index.y + y);
      });
    };
    collect(tile.passed, &drawing.passed);
    collect(tile.hit, &drawing.hit);
  }
  return drawing;
}

ScanPoints Read(const LaserGeometry& laser, const std::vector<float>& ranges, RangeUse use = {}) {
  return ScanReader(use).Read(laser, ranges);
}

TEST(Rasteriser, DrawsABeamCellByCell) {
  LaserGeometry laser = test::Laser(1);
  laser.first_angle = 0;
  // From the middle of cell (2, 3) to the right: to (2.55 + 0.5) / 0.1.
  Drawing drawing = Draw(Read(laser, {0.5f}), {0.25, 0.35, 0}, 0.1);
  EXPECT_EQ(drawing.passed, (std::set<Cell>{{2, 3}, {3, 3}, {4, 3}, {5, 3}, {6, 3}}));
  EXPECT_EQ(drawing.hit, (std::set<Cell>{{7, 3}}));
  // Downwards, across x = 0 and y = 0 of the world.
  drawing = Draw(Read(laser, {0.3f}), {-0.05, 0.15, -test::kPi / 2}, 0.1);
  EXPECT_EQ(drawing.passed, (std::set<Cell>{{-1, 1}, {-1, 0}, {-1, -1}}));
  EXPECT_EQ(drawing.hit, (std::set<Cell>{{-1, -2}}));
  // Slanting: every cell that is crossed, also those that are only cut at a corner.
  drawing = Draw(Read(laser, {5.0f}), {0.5, 0.5, std::atan2(2, 1)}, 1);
  EXPECT_EQ(drawing.passed, (std::set<Cell>{{0, 0}, {0, 1}, {1, 1}, {1, 2}, {1, 3}, {2, 3}}));
  EXPECT_EQ(drawing.hit, (std::set<Cell>{{2, 4}}));
}

TEST(Rasteriser, DrawsARoom) {
  const LaserGeometry laser = test::Laser(3600);
  // Walls in the middle of cells 0 and 40, 0 and 30.
  std::vector<float> ranges = test::SweepRoom(laser, 3600, {2, 1.5, 0.3}, 4, 3);
  const Drawing drawing = Draw(Read(laser, ranges), {2.05, 1.55, 0.3}, 0.1);
  std::set<Cell> walls, inside;
  for (int x = 0; x <= 40; ++x)
    for (int y = 0; y <= 30; ++y) {
      const bool wall = x == 0 || x == 40 || y == 0 || y == 30;
      const bool corner = (x == 0 || x == 40) && (y == 0 || y == 30);
      if (!corner) (wall ? walls : inside).emplace(x, y);
    }
  for (const Cell& cell : walls) EXPECT_TRUE(drawing.hit.count(cell)) << cell.first << cell.second;
  EXPECT_EQ(drawing.passed, inside);
}

// What the definition says, without runs, groups and windows.
Drawing ByTheBook(const ScanPoints& points, const PlanarPose& pose, double resolution) {
  Drawing drawing;
  double start_x, start_y;
  pose.Transform(points.laser_x, points.laser_y, &start_x, &start_y);
  for (std::size_t i = 0; i < points.Size(); ++i) {
    double end_x, end_y;
    pose.Transform(points.x[i], points.y[i], &end_x, &end_y);
    // Where the beam crosses lines of the lattice, in order.
    std::set<double> crossings = {0, 1};
    const auto add = [&](double from, double to) {
      const double low = std::min(from, to) / resolution, high = std::max(from, to) / resolution;
      for (double line = std::ceil(low); line <= high; line += 1)
        crossings.insert((line * resolution - from) / (to - from));
    };
    add(start_x, end_x);
    add(start_y, end_y);
    for (auto a = crossings.begin(), b = std::next(a); b != crossings.end(); ++a, ++b) {
      const double middle = (*a + *b) / 2;
      drawing.passed.emplace(std::floor((start_x + middle * (end_x - start_x)) / resolution),
                             std::floor((start_y + middle * (end_y - start_y)) / resolution));
    }
    if (points.hit[i])
      drawing.hit.emplace(std::floor(end_x / resolution), std::floor(end_y / resolution));
  }
  for (const Cell& cell : drawing.hit) drawing.passed.erase(cell);
  return drawing;
}

TEST(Rasteriser, DrawsRunsAndFansAsBeamsByTheBook) {
  test::Team team(4);
  for (int round = 0; round < 60; ++round) {
    const int beams = round % 3 == 0 ? 33 : round % 3 == 1 ? 360 : 720;
    LaserGeometry laser = test::Laser(beams, round % 2 ? 2 * test::kPi : test::kPi);
    laser.robot_from_laser = {team.Uniform(-0.3, 0.3), team.Uniform(-0.3, 0.3),
                              team.Uniform(-0.2, 0.2)};
    const PlanarPose pose = {team.Uniform(-200, 200), team.Uniform(-200, 200), team.Uniform(-4, 4)};
    std::vector<float> ranges;
    for (int i = 0; i < beams; ++i)
      ranges.push_back(static_cast<float>(round % 5 == 0             ? 0.2 + 0.01 * i
                                          : team.Uniform(0, 1) < 0.8 ? 4 + std::sin(0.05 * i)
                                                                     : team.Uniform(0.1, 29)));
    const ScanPoints points = Read(laser, ranges);
    const Drawing drawing = Draw(points, pose, 0.1), book = ByTheBook(points, pose, 0.1);
    EXPECT_EQ(drawing.passed, book.passed) << "round " << round;
    EXPECT_EQ(drawing.hit, book.hit) << "round " << round;
  }
}

TEST(Rasteriser, AHitOutweighsWhatOtherBeamsOfTheScanPass) {
  LaserGeometry laser = test::Laser(2);
  laser.first_angle = 0;
  laser.step = 0.001;
  const Drawing drawing = Draw(Read(laser, {0.5f, 1.0f}), {0.05, 0.05, 0}, 0.1);
  EXPECT_EQ(drawing.hit, (std::set<Cell>{{5, 0}, {10, 0}}));
  EXPECT_FALSE(drawing.passed.count({5, 0}));
  EXPECT_TRUE(drawing.passed.count({6, 0}));
}

TEST(Rasteriser, ReadingsThatAreNoRangeSayNothing) {
  const LaserGeometry laser = test::Laser(8);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> none = {nan, infinity, -infinity, 0, -1, 30, 31, 1e30f};
  EXPECT_EQ(Read(laser, none).Size(), 0u);
  EXPECT_TRUE(Draw(Read(laser, none), {}, 0.1).passed.empty());
  // But those that did not return may be let pass as far as the range that is used.
  const ScanPoints cleared = Read(laser, none, {2.0, true});
  EXPECT_EQ(cleared.Size(), 3u);
  EXPECT_NEAR(cleared.reach, 2, 1e-6);
  EXPECT_TRUE(Draw(cleared, {}, 0.1).hit.empty());
  // A beam that is longer than the range that is used: the near part is passed, nothing hit.
  const Drawing cut =
      Draw(Read(test::Laser(1), {10.0f}, {2.0, false}), {0.05, 0.05, test::kPi}, 0.1);
  EXPECT_TRUE(cut.hit.empty());
  EXPECT_EQ(cut.passed.size(), 21u);
}

TEST(Rasteriser, RefusesGeometryThatIsNotFinite) {
  LaserGeometry laser = test::Laser(4);
  laser.step = std::numeric_limits<double>::infinity();
  testing::ExpectError(ErrorKind::kInput, {"geometry"}, [&] { Read(laser, {1, 1, 1, 1}); });
}

}  // namespace
}  // namespace graticule
