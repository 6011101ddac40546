#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/planar_pose.hpp"

namespace graticule {

/// What is known of a cell.
enum class Occupancy : std::uint8_t { kUnknown, kFree, kStructure };

/// A map of the plane in square cells.
struct OccupancyGrid {
  double resolution = 0.1;       ///< m, a cell's side
  PlanarPose map_from_grid;      ///< the outer corner of cell (0, 0): x to the right, y up
  std::size_t width = 0;         ///< cells in x
  std::size_t height = 0;        ///< cells in y
  std::vector<Occupancy> cells;  ///< row by row, the lowest first

  Occupancy At(std::size_t x, std::size_t y) const { return cells[y * width + x]; }
};

/// A map as ROS' map_server has it: a YAML file, and the picture that it names beside it.
///
/// Written: trinary; structure 0, free 254, unknown 205, with free_thresh 0.196 and occupied_thresh
/// 0.65, between which unknown (0.196 of the way) lies.  (With the 0.25 that is common it would be
/// read again as free.)
struct OccupancyFiles {
  std::string yaml;
  std::string pgm;  ///< binary (P5), the top row first
};

/// `image` is the name of the picture in the YAML file.
OccupancyFiles FormatOccupancy(const OccupancyGrid& grid, const std::string& image);

/// Writes PATH.yaml and PATH.pgm.  Throws Error (kOther): a full disk.
void WriteOccupancy(const OccupancyGrid& grid, const std::string& path_without_ending);

/// Reads a YAML file and its picture: PGM (P2, P5) or PNG of 8 or 16 bits, grey or colour.  Modes
/// trinary and scale; negate as map_server has it.  Throws Error "path:line: ...": what is missing,
/// not a number, a resolution that is not above zero, a picture that is cut short.
OccupancyGrid ReadOccupancy(const std::string& yaml_path);

/// The grid as a picture of one shade a cell, the top row first: structure black, free white,
/// unknown grey (205), as PNG.
std::string FormatOccupancyPng(const OccupancyGrid& grid);

}  // namespace graticule
