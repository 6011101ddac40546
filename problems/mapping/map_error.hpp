#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/problems/mapping/route.hpp"

namespace graticule {

/// How one map agrees with another, cell by cell, over all cells of either.
struct MapAgreement {
  /// Cells by what the reference says (first) and what the map says: unknown, free, structure.
  std::size_t cells[3][3] = {};

  std::size_t Count(Occupancy reference, Occupancy map) const {
    return cells[static_cast<int>(reference)][static_cast<int>(map)];
  }
  /// Of the cells where the map says so, those where the reference does.  Unknown in the reference
  /// counts neither way.  1 where there are none.
  double Precision(Occupancy what) const;
  /// Of the cells where the reference says so, those where the map does.
  double Recall(Occupancy what) const;
  /// Intersection over union, unknown included.
  double Iou(Occupancy what) const;
  /// Of the cells that the reference knows, those that the map knows.
  double KnownRecall() const;
  /// Of the cells that the reference knows, those of which the map says something else.
  double KnownChanged() const;
};

/// The map's cells against the reference, laid over each other by their frames; cells of the
/// reference that are finer are taken together: structure where one is, else free where one is.
/// Throws Error (kUsage): grids turned against each other, or cells of the reference that are
/// coarser.
MapAgreement CompareMaps(const OccupancyGrid& reference, const OccupancyGrid& map);

/// The map with so many unknown cells around it that it covers all of another.
OccupancyGrid Extended(const OccupancyGrid& map, const OccupancyGrid& other);

/// The reference on the cells of a map; what lies outside is left out.
OccupancyGrid Resample(const OccupancyGrid& reference, const OccupancyGrid& map);

/// Whether a robot's ways are the same in a map as in its reference: a doorway that the map closes,
/// a wall that it opens.
struct GapReport {
  std::size_t pairs = 0;  ///< places near each other that were tried
  using Way = std::pair<RoutePlanner::Point, RoutePlanner::Point>;
  /// The reference has a way for a robot of 0.3 m radius, the map none for one of 0.15 m.
  std::vector<Way> closed;
  /// The map has a way for a robot of 0.3 m radius, the reference none for one of 0.15 m.
  std::vector<Way> opened;
};

/// Tries so many pairs of places, 2 to 6 m from each other, both free in both maps.  There is no
/// way where it is longer than twice the other's and 3 m.  Unknown cells of either are walls in
/// both. Same seed, same pairs.  Throws as CompareMaps.
GapReport FindGaps(const OccupancyGrid& reference, const OccupancyGrid& map, std::size_t pairs,
                   std::uint64_t seed = 1);

}  // namespace graticule
