#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "graticule/problems/mapping/live_map.hpp"
#include "graticule/problems/mapping/map_error.hpp"

namespace graticule::test {

constexpr double kPi = 3.14159265358979323846;

/// Beams all around, or `beams` of them over `view`.
inline LaserGeometry Laser(int beams, double view = 2 * kPi) {
  LaserGeometry laser;
  laser.first_angle = -view / 2;
  laser.step = view / beams;
  laser.max_range = 30;
  return laser;
}

/// What the laser measures at a place in a room [0, width] x [0, height], m.
inline std::vector<float> SweepRoom(const LaserGeometry& laser, int beams, const PlanarPose& pose,
                                    double width, double height) {
  std::vector<float> ranges;
  const PlanarPose at = pose * laser.robot_from_laser;
  for (int i = 0; i < beams; ++i) {
    const double angle = at.yaw + laser.first_angle + i * laser.step;
    const double c = std::cos(angle), s = std::sin(angle);
    const double x = c > 0 ? (width - at.x) / c : c < 0 ? -at.x / c : 1e9;
    const double y = s > 0 ? (height - at.y) / s : s < 0 ? -at.y / s : 1e9;
    ranges.push_back(static_cast<float>(std::min(x, y)));
  }
  return ranges;
}

/// A team that wanders through a room, with readings of all kinds.
struct Team {
  explicit Team(unsigned seed) : random(seed) {}

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  std::vector<float> Ranges(const LaserGeometry& laser, int beams, const PlanarPose& pose) {
    std::vector<float> ranges = SweepRoom(laser, beams, pose, 12, 9);
    for (float& range : ranges) {
      range += static_cast<float>(Uniform(-0.05, 0.05));
      const double what = Uniform(0, 1);
      if (what < 0.05) range = static_cast<float>(Uniform(0.1, 3));  // somebody
      if (what > 0.96) range = 30;                                   // no return
      if (what > 0.97) range = NAN;
      if (what > 0.98) range = 0;
      if (what > 0.99) range = INFINITY;
    }
    return ranges;
  }
  PlanarPose Place() { return {Uniform(1, 11), Uniform(1, 8), Uniform(-kPi, kPi)}; }

  std::mt19937 random;
};

/// The map made from scratch of the nodes that are in another, where that has them.
struct Node {
  std::uint32_t robot;
  LaserGeometry laser;
  std::vector<float> ranges;
};
inline std::shared_ptr<const OccupancyMap> Fresh(const LiveMap& map, LiveMapOptions options,
                                                 const std::vector<Node>& nodes) {
  options.method = MapMethod::kNaive;
  LiveMap fresh(options);
  for (const NodeId id : map.Cover())
    fresh.AddNode(nodes[id].robot, nodes[id].laser, nodes[id].ranges, map.DrawnPose(id));
  fresh.Update();
  return fresh.Map();
}

/// Cells of the same label, the same removed ones, and the same frontier.
inline bool SameMap(const OccupancyMap& a, const OccupancyMap& b) {
  const auto contained = [](const OccupancyMap& one, const OccupancyMap& other) {
    bool same = true;
    one.AllPages().ForEach([&](TileIndex page, const std::shared_ptr<const MapPage>& tiles) {
      if (!tiles) return;
      for (int place = 0; place < kPageTiles; ++place) {
        const MapTile& here = tiles->tiles[place];
        const MapTile& there = other.TileAt(TileOfPage(page, place));
        same = same && here.structure == there.structure && here.free == there.free &&
               here.removed == there.removed && here.frontier == there.frontier;
      }
    });
    return same;
  };
  return contained(a, b) && contained(b, a);
}

}  // namespace graticule::test
