#pragma once

#include <cstdint>
#include <optional>
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

  /// The grid is not kept.
  RoutePlanner(const OccupancyGrid& grid, double clearance_m, double cell_m = 0.4);

  /// Centres of cells that a robot may stand on, and that are joined with the largest such region.
  const std::vector<Point>& Places() const { return places_; }

  /// The shortest way, as corners to drive straight between; empty where there is none.  Both ends
  /// are moved to the next place.
  std::vector<Point> Route(const Point& from, const Point& to) const;

 private:
  std::size_t CellOf(const Point& point) const;
  Point CentreOf(std::size_t cell) const;
  bool IsClear(const Point& from, const Point& to) const;
  bool IsOpen(std::size_t cell) const { return open_[cell] != 0; }

  double cell_m_, left_, bottom_;
  std::size_t width_ = 0, height_ = 0;
  std::vector<std::uint8_t> open_;
  std::vector<Point> places_;
};

}  // namespace graticule
