#include "graticule/problems/mapping/gnss_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace graticule {
namespace {

constexpr std::size_t kLooked = 200;  // points that pairs are of, spread over all
constexpr std::size_t kTried = 600;   // pairs, the farthest apart
constexpr double kAgrees = 3;         // deviations
constexpr double kCauchy = 2;         // deviations
constexpr int kRounds = 15;

// In deviations.
double Miss(const GroundPoint& point, const PlanarPose& ground_from_map) {
  double east = 0, north = 0;
  ground_from_map.Transform(point.x, point.y, &east, &north);
  return std::hypot(east - point.east, north - point.north) / point.sigma;
}

// Of two points; their middles fall together.
PlanarPose PoseOfPair(const GroundPoint& a, const GroundPoint& b) {
  PlanarPose pose;
  pose.yaw = WrappedAngle(std::atan2(b.north - a.north, b.east - a.east) -
                          std::atan2(b.y - a.y, b.x - a.x));
  double east = 0, north = 0;
  pose.Transform((a.x + b.x) / 2, (a.y + b.y) / 2, &east, &north);
  pose.x = (a.east + b.east) / 2 - east;
  pose.y = (a.north + b.north) / 2 - north;
  return pose;
}

PlanarPose BestOfPairs(const std::vector<GroundPoint>& points) {
  std::vector<GroundPoint> looked;
  const std::size_t step = (points.size() + kLooked - 1) / kLooked;
  for (std::size_t i = 0; i < points.size(); i += step) looked.push_back(points[i]);
  struct Pair {
    double apart;
    std::size_t a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < looked.size(); ++a)
    for (std::size_t b = a + 1; b < looked.size(); ++b)
      pairs.push_back({std::hypot(looked[b].x - looked[a].x, looked[b].y - looked[a].y), a, b});
  // The farther half of all, thinned: not only those of one bad point at the edge.
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.apart > b.apart; });
  pairs.resize((pairs.size() + 1) / 2);
  const std::size_t thinned = (pairs.size() + kTried - 1) / kTried;
  PlanarPose best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pairs.size(); i += thinned) {
    const PlanarPose pose = PoseOfPair(looked[pairs[i].a], looked[pairs[i].b]);
    double cost = 0;
    for (const GroundPoint& point : looked) {
      const double miss = std::min(Miss(point, pose), kAgrees);
      cost += miss * miss;
    }
    if (cost < least) {
      least = cost;
      best = pose;
    }
  }
  return best;
}

// One step of iteratively reweighted least squares.
void Refine(const std::vector<GroundPoint>& points, GroundAlignment* alignment) {
  std::vector<double> weights;
  double sum = 0, x = 0, y = 0, east = 0, north = 0;
  for (const GroundPoint& point : points) {
    const double miss = Miss(point, alignment->ground_from_map) / kCauchy;
    const double weight = 1 / (point.sigma * point.sigma * (1 + miss * miss));
    weights.push_back(weight);
    sum += weight;
    x += weight * point.x;
    y += weight * point.y;
    east += weight * point.east;
    north += weight * point.north;
  }
  x /= sum;
  y /= sum;
  east /= sum;
  north /= sum;
  double dot = 0, cross = 0, spread = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double dx = points[i].x - x, dy = points[i].y - y;
    const double de = points[i].east - east, dn = points[i].north - north;
    dot += weights[i] * (dx * de + dy * dn);
    cross += weights[i] * (dx * dn - dy * de);
    spread += weights[i] * (dx * dx + dy * dy);
  }
  PlanarPose& pose = alignment->ground_from_map;
  pose = {0, 0, std::atan2(cross, dot)};
  double turned_x = 0, turned_y = 0;
  pose.Transform(x, y, &turned_x, &turned_y);
  pose.x = east - turned_x;
  pose.y = north - turned_y;
  alignment->sigma_yaw = 1 / std::sqrt(spread);
  alignment->sigma = 1 / std::sqrt(sum);
  alignment->middle_x = x;
  alignment->middle_y = y;
}

}  // namespace

GroundAlignment AlignToGround(const std::vector<GroundPoint>& points) {
  GroundAlignment alignment;
  alignment.sigma_yaw = std::numeric_limits<double>::infinity();
  if (points.size() < 2) return alignment;
  alignment.ground_from_map = BestOfPairs(points);
  for (int round = 0; round < kRounds; ++round) Refine(points, &alignment);
  for (const GroundPoint& point : points)
    alignment.agreeing += Miss(point, alignment.ground_from_map) <= kAgrees;
  return alignment;
}

}  // namespace graticule
