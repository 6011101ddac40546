#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "graticule/io/occupancy.hpp"

namespace graticule {

/// A map with what was driven over it, as plain data: what DrawMap draws.  Metres, in the map's
/// frame.
struct MapDrawing {
  struct Point {
    double x = 0, y = 0;
  };
  struct Line {
    std::string name;
    std::vector<Point> points;
  };

  std::string title, subtitle;
  OccupancyGrid grid;  ///< not turned against the map's frame
  std::vector<Line> trajectories;
  std::vector<std::pair<Point, Point>> closures;
};

/// Draws the map in shades (structure dark, free white, unknown grey), the trajectories in colours
/// and the loop closures as thin lines, with a legend and a scale bar: an SVG document that carries
/// the map as a picture inside, one pixel a cell.
std::string DrawMap(const MapDrawing& drawing);

}  // namespace graticule
