#include "graticule/problems/mapping/map_error.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kNarrow = 0.15, kWide = 0.3;  // m, a robot's radius

double Share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 1 : static_cast<double>(part) / static_cast<double>(whole);
}

OccupancyGrid WithWalls(const OccupancyGrid& grid, const OccupancyGrid& other) {
  OccupancyGrid walled = grid;
  for (std::size_t i = 0; i < walled.cells.size(); ++i)
    if (walled.cells[i] == Occupancy::kUnknown || other.cells[i] == Occupancy::kUnknown)
      walled.cells[i] = Occupancy::kStructure;
  return walled;
}

double Length(const std::vector<RoutePlanner::Point>& way) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < way.size(); ++i)
    length += std::hypot(way[i + 1].x - way[i].x, way[i + 1].y - way[i].y);
  return length;
}

}  // namespace

double MapAgreement::Precision(Occupancy what) const {
  const std::size_t right = Count(what, what);
  std::size_t said = 0;
  for (const Occupancy truth : {Occupancy::kFree, Occupancy::kStructure})
    said += Count(truth, what);
  return Share(right, said);
}

double MapAgreement::Recall(Occupancy what) const {
  std::size_t there = 0;
  for (int map = 0; map < 3; ++map) there += cells[static_cast<int>(what)][map];
  return Share(Count(what, what), there);
}

double MapAgreement::Iou(Occupancy what) const {
  std::size_t either = 0;
  for (int k = 0; k < 3; ++k)
    either += cells[static_cast<int>(what)][k] + cells[k][static_cast<int>(what)];
  const std::size_t both = Count(what, what);
  return Share(both, either - both);
}

double MapAgreement::KnownRecall() const {
  std::size_t known = 0, lost = 0;
  for (const Occupancy truth : {Occupancy::kFree, Occupancy::kStructure}) {
    for (int map = 0; map < 3; ++map) known += cells[static_cast<int>(truth)][map];
    lost += Count(truth, Occupancy::kUnknown);
  }
  return Share(known - lost, known);
}

double MapAgreement::KnownChanged() const {
  std::size_t known = 0, changed = 0;
  for (const Occupancy truth : {Occupancy::kFree, Occupancy::kStructure}) {
    for (int map = 0; map < 3; ++map) known += cells[static_cast<int>(truth)][map];
    changed += Count(truth, truth == Occupancy::kFree ? Occupancy::kStructure : Occupancy::kFree) +
               Count(truth, Occupancy::kUnknown);
  }
  return known == 0 ? 0 : Share(changed, known);
}

OccupancyGrid Extended(const OccupancyGrid& map, const OccupancyGrid& other) {
  const PlanarPose map_from_other = Inverse(map.map_from_grid) * other.map_from_grid;
  const auto beyond = [&](double metres) {  // cells, rounding errors of a corner aside
    return static_cast<std::size_t>(std::max(0.0, std::ceil(metres / map.resolution - 1e-6)));
  };
  const auto side = [](std::size_t cells, double metres) {
    return static_cast<double>(cells) * metres;
  };
  const std::size_t left = beyond(-map_from_other.x), below = beyond(-map_from_other.y);
  const std::size_t right = beyond(map_from_other.x + side(other.width, other.resolution) -
                                   side(map.width, map.resolution));
  const std::size_t above = beyond(map_from_other.y + side(other.height, other.resolution) -
                                   side(map.height, map.resolution));
  OccupancyGrid grid;
  grid.resolution = map.resolution;
  grid.width = left + map.width + right;
  grid.height = below + map.height + above;
  grid.map_from_grid =
      map.map_from_grid * PlanarPose{-side(left, map.resolution), -side(below, map.resolution), 0};
  grid.cells.assign(grid.width * grid.height, Occupancy::kUnknown);
  for (std::size_t y = 0; y < map.height; ++y)
    std::copy_n(map.cells.data() + y * map.width, map.width,
                grid.cells.data() + (y + below) * grid.width + left);
  return grid;
}

OccupancyGrid Resample(const OccupancyGrid& reference, const OccupancyGrid& map) {
  if (std::abs(WrappedAngle(reference.map_from_grid.yaw - map.map_from_grid.yaw)) > 1e-9)
    throw Error("the maps are turned against each other", ErrorKind::kUsage);
  if (reference.resolution > map.resolution * (1 + 1e-9))
    throw Error("the reference has coarser cells than the map", ErrorKind::kUsage);
  OccupancyGrid resampled = map;
  std::fill(resampled.cells.begin(), resampled.cells.end(), Occupancy::kUnknown);
  const PlanarPose map_from_reference = Inverse(map.map_from_grid) * reference.map_from_grid;
  for (std::size_t y = 0; y < reference.height; ++y)
    for (std::size_t x = 0; x < reference.width; ++x) {
      const double px =
          map_from_reference.x + (static_cast<double>(x) + 0.5) * reference.resolution;
      const double py =
          map_from_reference.y + (static_cast<double>(y) + 0.5) * reference.resolution;
      const double column = std::floor(px / map.resolution), row = std::floor(py / map.resolution);
      if (!(column >= 0 && row >= 0 && column < static_cast<double>(map.width) &&
            row < static_cast<double>(map.height)))
        continue;
      Occupancy& cell =
          resampled
              .cells[static_cast<std::size_t>(row) * map.width + static_cast<std::size_t>(column)];
      cell = std::max(cell, reference.At(x, y));  // unknown, free, structure
    }
  return resampled;
}

MapAgreement CompareMaps(const OccupancyGrid& reference, const OccupancyGrid& map) {
  const OccupancyGrid whole = Extended(map, reference), laid = Resample(reference, whole);
  MapAgreement agreement;
  for (std::size_t i = 0; i < whole.cells.size(); ++i)
    ++agreement.cells[static_cast<int>(laid.cells[i])][static_cast<int>(whole.cells[i])];
  return agreement;
}

GapReport FindGaps(const OccupancyGrid& reference, const OccupancyGrid& map, std::size_t pairs,
                   std::uint64_t seed) {
  const OccupancyGrid laid = Resample(reference, map);
  const OccupancyGrid true_walls = WithWalls(laid, map), map_walls = WithWalls(map, laid);
  const double cell = map.resolution;
  const RoutePlanner true_wide(true_walls, kWide, cell, true),
      true_narrow(true_walls, kNarrow, cell, true);
  const RoutePlanner map_wide(map_walls, kWide, cell, true),
      map_narrow(map_walls, kNarrow, cell, true);
  GapReport report;
  RandomNumbers random(seed);
  const std::vector<RoutePlanner::Point>& places = true_wide.Places();
  if (places.empty()) return report;
  for (std::size_t tries = 0; report.pairs < pairs && tries < 100 * pairs; ++tries) {
    const RoutePlanner::Point from = places[random.Below(places.size())];
    const double angle = random.Uniform(0, 2 * M_PI), away = random.Uniform(2, 6);
    const RoutePlanner::Point to{from.x + away * std::cos(angle), from.y + away * std::sin(angle)};
    const auto stands = [&](const RoutePlanner& planner) {
      return planner.CanStand(from) && planner.CanStand(to);
    };
    if (!stands(true_wide) || !stands(map_wide)) continue;
    ++report.pairs;
    const auto blocked = [&](const RoutePlanner& wide, const RoutePlanner& narrow) {
      constexpr double kLongest = 12;
      const auto way = wide.Route(from, to, kLongest);
      if (way.empty()) return false;
      if (!narrow.CanStand(from) || !narrow.CanStand(to)) return true;
      return narrow.Route(from, to, 2 * Length(way) + 3).empty();
    };
    if (blocked(true_wide, map_narrow)) report.closed.emplace_back(from, to);
    if (blocked(map_wide, true_narrow)) report.opened.emplace_back(from, to);
  }
  return report;
}

}  // namespace graticule
