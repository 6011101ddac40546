#pragma once

#include <cstdint>
#include <vector>

#include "graticule/io/occupancy.hpp"

namespace graticule {

/// A town to be mapped: streets around blocks, and on them houses of rooms along a corridor, with
/// doors, or yards with trees and parked cars.
struct TownOptions {
  double width_m = 100, height_m = 80;
  double block_m = 30;  ///< from street to street
  double street_m = 7;  ///< their width
  double yards = 0.25;  ///< share of blocks without a house
  /// Cars and trees along the streets, so many for each block; off the gate, where robots start.
  int street_things = 0;
  double resolution = 0.05;  ///< m, a cell's side
  std::uint64_t seed = 1;
};

/// What a cell of a town is.
enum class TownThing : std::uint8_t { kOpen, kWall, kPartition, kFurniture, kTree, kCar };

struct Town {
  /// The truth: every cell structure or free; (0, 0) is the lower left corner.
  OccupancyGrid grid;
  /// What each of its cells is: kOpen where it is free.  Outer walls of houses and of the town are
  /// kWall, walls between rooms kPartition.
  std::vector<TownThing> things;
  /// The outlines of houses [m].
  struct House {
    double x0, y0, x1, y1;
  };
  std::vector<House> houses;
  /// Centres of doors [m], and which way they lead: along x or along y.
  struct Door {
    double x, y;
    bool along_x;
  };
  std::vector<Door> doors;
};

/// Same options, same town.  Throws Error (kUsage): a town of less than one block, or of more than
/// 2^30 cells.
Town MakeTown(const TownOptions& options);

/// How far it is from a point to the next structure along a beam, in m, up to `most`; `most` where
/// there is none.  Amanatides and Woo's traversal.
double CastRay(const OccupancyGrid& grid, double x, double y, double angle, double most);

}  // namespace graticule
