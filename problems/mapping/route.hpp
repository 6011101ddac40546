#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "graticule/io/occupancy.hpp"

namespace graticule {

/// Finds ways for a robot of some width over a map: on coarse cells, those that keep their distance
/// from structure.
class RoutePlanner {
 public:
  struct Point {
    double x = 0, y = 0;  ///< m
  };

  /// The grid is not kept.  Only the largest region of cells that are joined, unless all are asked
  /// for.
  RoutePlanner(const OccupancyGrid& grid, double clearance_m, double cell_m = 0.4,
               bool all_regions = false);

  /// Centres of cells that a robot may stand on.
  const std::vector<Point>& Places() const { return places_; }

  /// Whether it is inside the map, and a place.
  bool CanStand(const Point& point) const;

  /// The shortest way, as corners to drive straight between; empty where there is none, or none
  /// along cells that is `most_m` long at most.  Both ends are moved to the next place.
  std::vector<Point> Route(const Point& from, const Point& to,
                           double most_m = std::numeric_limits<double>::infinity()) const;

 private:
  std::size_t CellOf(const Point& point) const;
  Point CentreOf(std::size_t cell) const;
  std::pair<std::size_t, std::size_t> Reach(std::size_t at, std::size_t count, double most_m) const;
  bool IsClear(const Point& from, const Point& to) const;
  bool IsOpen(std::size_t cell) const { return open_[cell] != 0; }

  double cell_m_, left_, bottom_;
  std::size_t width_ = 0, height_ = 0;
  std::vector<std::uint8_t> open_;
  std::vector<Point> places_;
};

}  // namespace graticule
