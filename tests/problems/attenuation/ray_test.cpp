#include "graticule/problems/attenuation/ray.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Pieces = std::map<std::tuple<std::uint32_t, std::int32_t, std::int32_t>, double>;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Blocks of one class, and cells of any.
std::vector<std::uint8_t> RandomClasses(std::size_t width, std::size_t height, int classes,
                                        RandomNumbers* random) {
  std::vector<std::uint8_t> cells(width * height);
  const auto any = [&] {
    return static_cast<std::uint8_t>(random->Below(static_cast<std::uint64_t>(classes)));
  };
  for (std::size_t y0 = 0; y0 < height; y0 += 20)
    for (std::size_t x0 = 0; x0 < width; x0 += 20) {
      const bool mixed = random->Unit() < 0.3;
      const std::uint8_t c = any();
      for (std::size_t y = y0; y < std::min(height, y0 + 20); ++y)
        for (std::size_t x = x0; x < std::min(width, x0 + 20); ++x)
          cells[y * width + x] = mixed ? any() : c;
    }
  return cells;
}

/// The part of a segment inside of a rectangle, by clipping against each side.
double PartInside(const Vector2d& a, const Vector2d& b, const Vector2d& low, const Vector2d& high) {
  double in = 0, out = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double by = b[axis] - a[axis];
    if (by == 0) {
      if (a[axis] < low[axis] || a[axis] >= high[axis]) return 0;
      continue;
    }
    const double t0 = (low[axis] - a[axis]) / by, t1 = (high[axis] - a[axis]) / by;
    in = std::max(in, std::min(t0, t1));
    out = std::min(out, std::max(t0, t1));
  }
  return std::max(0.0, out - in);
}

/// The slow way: the ray against every cell of the map, each cut by every coarse cell; the map's
/// axes are the frame's here.
Pieces Clipped(const ClassMap& map, double coarse_m, const Vector3d& a, const Vector3d& b) {
  Pieces pieces;
  const double length = (b - a).norm(), r = map.Resolution();
  const Vector2d from = a.head<2>(), to = b.head<2>();
  const Vector2d origin(map.MapFromGrid().x, map.MapFromGrid().y);
  const Vector2d low = from.cwiseMin(to), high = from.cwiseMax(to);
  const auto coarse = [&](double v) { return static_cast<std::int32_t>(std::floor(v / coarse_m)); };
  for (std::int32_t cy = coarse(low.y()); cy <= coarse(high.y()); ++cy)
    for (std::int32_t cx = coarse(low.x()); cx <= coarse(high.x()); ++cx) {
      const Vector2d c0(cx * coarse_m, cy * coarse_m), c1((cx + 1) * coarse_m, (cy + 1) * coarse_m);
      double outside = PartInside(from, to, c0, c1);
      for (std::int64_t y = 0; y < map.Height(); ++y)
        for (std::int64_t x = 0; x < map.Width(); ++x) {
          const Vector2d f0 = origin + r * Vector2d(x, y), f1 = origin + r * Vector2d(x + 1, y + 1);
          const Vector2d l = f0.cwiseMax(c0), h = f1.cwiseMin(c1);
          if ((l.array() >= h.array()).any()) continue;
          const double part = PartInside(from, to, l, h);
          outside -= part;
          if (part > 0) pieces[{map.At(x, y), cx, cy}] += part * length;
        }
      if (outside > 1e-14) pieces[{map.Outside(), cx, cy}] += outside * length;
    }
  return pieces;
}

Pieces Summed(const std::vector<RayPiece>& pieces) {
  Pieces sums;
  for (const RayPiece& p : pieces) {
    EXPECT_EQ(sums.count({p.material, p.x, p.y}), 0u) << "a pair comes twice";
    sums[{p.material, p.x, p.y}] += p.length_m;
  }
  return sums;
}

void ExpectSame(const Pieces& found, const Pieces& expected) {
  for (const auto& [key, length] : expected) {
    const auto at = found.find(key);
    EXPECT_NEAR(at == found.end() ? 0 : at->second, length, 1e-11);
  }
  for (const auto& [key, length] : found)
    if (expected.count(key) == 0) {
      EXPECT_LT(length, 1e-11);
    }
}

TEST(Ray, IsAsLongInEveryCellAsClippingSays) {
  RandomNumbers random(3);
  for (int world = 0; world < 6; ++world) {
    const std::size_t width = 30 + random.Below(40), height = 30 + random.Below(40);
    const double x0 = random.Uniform(-3, 3), y0 = random.Uniform(-3, 3);
    const ClassMap map(0.1, {x0, y0, 0}, width, height, RandomClasses(width, height, 4, &random),
                       2);
    RayTracer tracer(&map, 0.73);
    for (int i = 0; i < 60; ++i) {
      const auto place = [&] {
        return Vector3d(random.Uniform(x0 - 1, x0 + 8), random.Uniform(y0 - 1, y0 + 8),
                        i % 3 == 0 ? random.Uniform(0, 3) : 0);
      };
      const Vector3d a = place(), b = place();
      ExpectSame(Summed(tracer.Trace(a, b)), Clipped(map, 0.73, a, b));
    }
  }
}

TEST(Ray, SumsToItsLengthAndIsTheSameBothWays) {
  RandomNumbers random(5);
  const ClassMap map(0.1, {-7, 3, 0.4}, 400, 300, RandomClasses(400, 300, 3, &random), 2);
  RayTracer tracer(&map, 4);
  for (int i = 0; i < 3000; ++i) {
    const auto place = [&] {
      // Some on lines of cells, some far outside.
      const double x = random.Uniform(-30, 50), y = random.Uniform(-20, 60);
      return i % 5 == 0 ? Vector3d(std::round(x), std::round(y), 0) : Vector3d(x, y, 0);
    };
    const Vector3d a = place(), b = place();
    const std::vector<RayPiece> there = tracer.Trace(a, b);
    const std::vector<RayPiece> back = tracer.Trace(b, a);
    ASSERT_EQ(there.size(), back.size());
    double sum = 0;
    for (std::size_t k = 0; k < there.size(); ++k) {
      EXPECT_EQ(there[k].length_m, back[k].length_m);
      EXPECT_EQ(there[k].x, back[k].x);
      EXPECT_EQ(there[k].y, back[k].y);
      EXPECT_EQ(there[k].material, back[k].material);
      sum += there[k].length_m;
    }
    EXPECT_NEAR(sum, (a - b).norm(), 1e-12 * (1 + (a - b).norm()));
  }
}

// Along cells' edges a ray may be in the cells of either side; its length may not be lost.
TEST(Ray, FollowsAxesDiagonalsAndEdges) {
  RandomNumbers random(9);
  const ClassMap map(0.25, {0, 0, 0}, 64, 64, RandomClasses(64, 64, 3, &random), 2);
  RayTracer tracer(&map, 2);
  for (const Vector3d& a : {Vector3d(0, 0, 0), Vector3d(4, 4, 0), Vector3d(16, 16, 0),
                            Vector3d(3.3, 8, 0), Vector3d(-2, 4, 0)})
    for (const Vector3d& by : {Vector3d(8, 0, 0), Vector3d(0, 8, 0), Vector3d(8, 8, 0),
                               Vector3d(-8, 8, 0), Vector3d(16, -16, 0), Vector3d(0.1, 0, 0)}) {
      double sum = 0;
      for (const RayPiece& piece : tracer.Trace(a, a + by)) sum += piece.length_m;
      EXPECT_NEAR(sum, by.norm(), 1e-12);
    }
}

TEST(Ray, IsOfClassZeroWithoutAMapAndOfOneCellWithoutALattice) {
  RayTracer tracer(nullptr, 0);
  const auto& pieces = tracer.Trace({-3, 0, 0}, {1, 3, 0});
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_EQ(pieces[0].material, 0u);
  EXPECT_EQ(pieces[0].x, 0);
  EXPECT_DOUBLE_EQ(pieces[0].length_m, 5);
}

TEST(Ray, HasNoPiecesBetweenEndsAtOnePlaceAndAllOfItStraightUp) {
  const ClassMap map(0.1, {0, 0, 0}, 10, 10, std::vector<std::uint8_t>(100, 1), 0);
  RayTracer tracer(&map, 4);
  EXPECT_TRUE(tracer.Trace({0.5, 0.5, 0}, {0.5, 0.5, 0}).empty());
  const auto& up = tracer.Trace({0.5, 0.5, 0}, {0.5, 0.5, 2.5});
  ASSERT_EQ(up.size(), 1u);
  EXPECT_EQ(up[0].material, 1u);
  EXPECT_DOUBLE_EQ(up[0].length_m, 2.5);
}

TEST(Ray, RefusesAMapThatIsNone) {
  EXPECT_THROW(ClassMap(0, {}, 1, 1, {0}, 0), Error);
  EXPECT_THROW(ClassMap(0.1, {}, 0, 0, {}, 0), Error);
  EXPECT_THROW(ClassMap(0.1, {}, 2, 2, {0, 1, 0}, 0), Error);
  EXPECT_THROW(ClassMap(0.1, {}, 1, 1, {255}, 0), Error);
}

}  // namespace
}  // namespace graticule
