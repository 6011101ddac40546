#pragma once

// Internal to the simulation of signals.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/problems/mapping/route.hpp"
#include "graticule/problems/random.hpp"

namespace graticule {

/// Robots that drive to the nearest place they have not seen, away from each other, and draw a map
/// as they go.
class Exploration {
 public:
  Exploration(const OccupancyGrid& truth, int robots, double speed_m_s, double scan_range_m,
              std::uint64_t seed);

  void Drive(double seconds);
  void Scan();

  const std::vector<Eigen::Vector2d>& Positions() const { return positions_; }
  /// How far each robot has driven in the last Drive [m].
  const std::vector<double>& Driven() const { return driven_; }
  const OccupancyGrid& Map() const { return map_; }

 private:
  bool IsKnown(double x, double y) const;
  void ChooseGoal(std::size_t robot);

  const OccupancyGrid& truth_;
  RoutePlanner planner_;
  double speed_m_s_, scan_range_m_;
  RandomNumbers random_;
  OccupancyGrid map_;
  std::vector<Eigen::Vector2d> positions_, goals_;
  std::vector<std::vector<RoutePlanner::Point>> ways_;  // corners ahead, the next one last
  std::vector<double> driven_;
};

}  // namespace graticule
