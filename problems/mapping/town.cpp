#include "graticule/problems/mapping/town.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kWall = 0.2, kRoomDoor = 1.0, kHouseDoor = 1.4, kCorridor = 2.0;
constexpr std::uint64_t kStreetStream = 1;

class Builder {
 public:
  Builder(const TownOptions& options, Town* town)
      : options_(options),
        town_(*town),
        random_(options.seed),
        street_random_(options.seed, kStreetStream) {}

  void Build() {
    const double width = options_.width_m, height = options_.height_m;
    Fill(0, 0, width, kWall, TownThing::kWall);
    Fill(0, height - kWall, width, height, TownThing::kWall);
    Fill(0, 0, kWall, height, TownThing::kWall);
    Fill(width - kWall, 0, width, height, TownThing::kWall);
    const double pitch = options_.block_m + options_.street_m;
    const auto blocks = [&](double size) {
      return std::max(1, static_cast<int>((size - options_.street_m) / pitch));
    };
    const int columns = blocks(width), rows = blocks(height);
    // What is left over widens the blocks.
    const double block_x = (width - options_.street_m) / columns - options_.street_m;
    const double block_y = (height - options_.street_m) / rows - options_.street_m;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const double x = options_.street_m + column * (block_x + options_.street_m);
        const double y = options_.street_m + row * (block_y + options_.street_m);
        if (random_.Unit() < options_.yards)
          Yard(x, y, x + block_x, y + block_y);
        else
          House(x + 1, y + 1, x + block_x - 1, y + block_y - 1);
      }
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        LineStreets(options_.street_m + column * (block_x + options_.street_m),
                    options_.street_m + row * (block_y + options_.street_m), block_x, block_y);
  }

 private:
  void Fill(double x0, double y0, double x1, double y1, TownThing thing) {
    OccupancyGrid& grid = town_.grid;
    const auto cell = [&](double metres, std::size_t most) {
      const double at = std::round(metres / grid.resolution);
      return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(most)));
    };
    for (std::size_t y = cell(y0, grid.height); y < cell(y1, grid.height); ++y)
      for (std::size_t x = cell(x0, grid.width); x < cell(x1, grid.width); ++x) {
        grid.cells[y * grid.width + x] =
            thing == TownThing::kOpen ? Occupancy::kFree : Occupancy::kStructure;
        town_.things[y * grid.width + x] = thing;
      }
  }
  // A wall along x or y; `at` is its middle across.
  void Wall(bool along_x, double at, double from, double to, TownThing what = TownThing::kWall) {
    const double low = at - kWall / 2, high = at + kWall / 2;
    along_x ? Fill(from, low, to, high, what) : Fill(low, from, high, to, what);
  }
  // A gap in such a wall, which leads through it.
  void Door(bool wall_along_x, double at, double middle, double width) {
    const double low = at - kWall, high = at + kWall;
    const double from = middle - width / 2, to = middle + width / 2;
    wall_along_x ? Fill(from, low, to, high, TownThing::kOpen)
                 : Fill(low, from, high, to, TownThing::kOpen);
    if (wall_along_x)
      town_.doors.push_back({middle, at, false});
    else
      town_.doors.push_back({at, middle, true});
  }

  // Rooms on both sides of a corridor along x, which leads out at both ends.
  void House(double x0, double y0, double x1, double y1) {
    const double half = kWall / 2;
    town_.houses.push_back({x0, y0, x1, y1});
    Wall(true, y0 + half, x0, x1);
    Wall(true, y1 - half, x0, x1);
    Wall(false, x0 + half, y0, y1);
    Wall(false, x1 - half, y0, y1);
    const double middle = 0.5 * (y0 + y1) + (random_.Unit() - 0.5) * 0.2 * (y1 - y0);
    const double low = middle - kCorridor / 2, high = middle + kCorridor / 2;
    Wall(true, low - half, x0, x1, TownThing::kPartition);
    Wall(true, high + half, x0, x1, TownThing::kPartition);
    Door(false, x0 + half, middle, kHouseDoor);
    Door(false, x1 - half, middle, kHouseDoor);
    for (const bool above : {false, true}) {
      double from = x0 + kWall;
      const double bottom = above ? high + kWall : y0, top = above ? y1 : low - kWall;
      while (from < x1 - 3) {
        double to = from + 4 + 4 * random_.Unit();
        if (x1 - to < 4) to = x1 - kWall;
        if (to < x1 - kWall - 0.01) Wall(false, to + half, bottom, top, TownThing::kPartition);
        const double door = from + 0.8 + (to - from - 1.6) * random_.Unit();
        Door(true, above ? high + half : low - half, door, kRoomDoor);
        // Some rooms lead out into the street as well.
        if (random_.Unit() < 0.15) Door(true, above ? y1 - half : y0 + half, door, kRoomDoor);
        Furnish(from, bottom, to, top);
        from = to + kWall;
      }
    }
  }
  // Desks and shelves along the walls, off the doors.
  void Furnish(double x0, double y0, double x1, double y1) {
    if (x1 - x0 < 3 || y1 - y0 < 4 || random_.Unit() < 0.3) return;
    const double x = x0 + 0.4 + (x1 - x0 - 2.4) * random_.Unit();
    const double y = y0 + 1.8 + (y1 - y0 - 4.0) * random_.Unit();
    Fill(x, y, x + 0.8 + 0.8 * random_.Unit(), y + 0.6, TownThing::kFurniture);
  }
  // Beside the four sides of a block, in its streets.
  void LineStreets(double x0, double y0, double width, double height) {
    constexpr double kCarLength = 4.2, kCarWidth = 1.8, kTrunk = 0.4, kGate = 16;
    for (int i = 0; i < options_.street_things; ++i) {
      const bool along_x = street_random_.Unit() < 0.5, beyond = street_random_.Unit() < 0.5;
      const bool is_car = street_random_.Unit() < 0.6;
      const double length = is_car ? kCarLength : kTrunk, across = is_car ? kCarWidth : kTrunk;
      const double side = along_x ? width : height, depth = along_x ? height : width;
      const double at = 1 + street_random_.Unit() * (side - 2 - length);
      // Cars stand in the street, trees on the strip before the houses.
      const double near =
          is_car ? (beyond ? depth + 0.2 : -0.2 - across) : (beyond ? depth - 0.7 : 0.3);
      const double x = x0 + (along_x ? at : near), y = y0 + (along_x ? near : at);
      if (x < kGate && y < kGate) continue;
      Fill(x, y, x + (along_x ? length : across), y + (along_x ? across : length),
           is_car ? TownThing::kCar : TownThing::kTree);
    }
  }
  void Yard(double x0, double y0, double x1, double y1) {
    const double area = (x1 - x0) * (y1 - y0);
    for (int i = 0; i < static_cast<int>(area / 60); ++i) {
      const double x = x0 + 2 + (x1 - x0 - 4) * random_.Unit();
      const double y = y0 + 2 + (y1 - y0 - 4) * random_.Unit();
      if (random_.Unit() < 0.5) {  // a tree
        Fill(x - 0.2, y - 0.2, x + 0.2, y + 0.2, TownThing::kTree);
      } else if (random_.Unit() < 0.5) {  // a car
        Fill(x - 2.1, y - 0.9, x + 2.1, y + 0.9, TownThing::kCar);
      } else {
        Fill(x - 0.9, y - 2.1, x + 0.9, y + 2.1, TownThing::kCar);
      }
    }
  }

  const TownOptions& options_;
  Town& town_;
  RandomNumbers random_, street_random_;  // houses are the same whatever stands in the streets
};

}  // namespace

Town MakeTown(const TownOptions& options) {
  const auto demand = [](bool fine, const char* what) {
    if (!fine) throw Error(std::string("simulated town: expected ") + what, ErrorKind::kUsage);
  };
  demand(options.block_m >= 16 && options.street_m >= 3,
         "blocks of 16 m and streets of 3 m at least");
  const double least = options.block_m + 2 * options.street_m;
  demand(options.width_m >= least && options.height_m >= least, "a town of one block at least");
  demand(options.street_things >= 0, "0 or more things in the streets");
  demand(options.yards >= 0 && options.yards <= 1, "a share of yards of 0 to 1");
  demand(options.resolution > 0 && options.resolution <= 0.2, "cells of 0.2 m or less");
  const double columns = std::ceil(options.width_m / options.resolution);
  const double rows = std::ceil(options.height_m / options.resolution);
  demand(columns * rows <= 1 << 30, "less than 2^30 cells");
  Town town;
  town.grid.resolution = options.resolution;
  town.grid.width = static_cast<std::size_t>(columns);
  town.grid.height = static_cast<std::size_t>(rows);
  town.grid.cells.assign(town.grid.width * town.grid.height, Occupancy::kFree);
  town.things.assign(town.grid.cells.size(), TownThing::kOpen);
  Builder(options, &town).Build();
  return town;
}

double CastRay(const OccupancyGrid& grid, double x, double y, double angle, double most) {
  const double px = (x - grid.map_from_grid.x) / grid.resolution;
  const double py = (y - grid.map_from_grid.y) / grid.resolution;
  auto column = static_cast<long>(std::floor(px)), row = static_cast<long>(std::floor(py));
  const double dx = std::cos(angle), dy = std::sin(angle);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const long step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? 1 : -1;
  const double per_x = dx != 0 ? 1 / std::abs(dx) : kNever;
  const double per_y = dy != 0 ? 1 / std::abs(dy) : kNever;
  const auto first = [](double p, double direction, double per) {
    const double within = p - std::floor(p);
    return direction > 0 ? (1 - within) * per : direction < 0 ? within * per : kNever;
  };
  double next_x = first(px, dx, per_x), next_y = first(py, dy, per_y), reached = 0;
  const double end = most / grid.resolution;
  const auto width = static_cast<long>(grid.width), height = static_cast<long>(grid.height);
  while (reached < end) {
    if (column < 0 || row < 0 || column >= width || row >= height) return most;
    if (grid.At(static_cast<std::size_t>(column), static_cast<std::size_t>(row)) ==
        Occupancy::kStructure)
      return reached * grid.resolution;
    if (next_x < next_y) {
      reached = next_x;
      next_x += per_x;
      column += step_x;
    } else {
      reached = next_y;
      next_y += per_y;
      row += step_y;
    }
  }
  return most;
}

}  // namespace graticule
