#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/io/occupancy.hpp"

namespace graticule {

/// What each cell of a map is made of: one of several classes (free, structure, unknown, ...), with
/// a summary of its tiles, so that rays step over regions of one class.
class ClassMap {
 public:
  static constexpr int kTile = 8;              ///< cells, a tile's side
  static constexpr std::uint8_t kMixed = 255;  ///< of a tile: more than one class

  /// `class_of` says which class a cell is of that is unknown, free, structure, in the order of
  /// Occupancy.  What lies outside of the map is unknown.  Throws Error: a grid whose cells are not
  /// width x height, no resolution above zero, a class of 255.
  ClassMap(const OccupancyGrid& grid, const std::array<std::uint8_t, 3>& class_of);

  /// Any classes below 255, row by row, the lowest first.  Throws Error as above.
  ClassMap(double resolution, const PlanarPose& map_from_grid, std::size_t width,
           std::size_t height, const std::vector<std::uint8_t>& classes, std::uint8_t outside);

  double Resolution() const { return resolution_; }
  const PlanarPose& MapFromGrid() const { return map_from_grid_; }
  std::int64_t Width() const { return width_; }
  std::int64_t Height() const { return height_; }
  std::uint8_t Outside() const { return outside_; }
  /// One more than the highest class.
  int ClassCount() const { return class_count_; }

  std::uint8_t At(std::int64_t x, std::int64_t y) const {
    return TileCells(x >> 3, y >> 3)[((y & 7) << 3) | (x & 7)];
  }
  /// The cells of a tile, row by row: they lie together in memory.
  const std::uint8_t* TileCells(std::int64_t tile_x, std::int64_t tile_y) const {
    return cells_.data() + (tile_y * tiles_x_ + tile_x) * (kTile * kTile);
  }
  /// The class of all cells of a tile, or kMixed.
  std::uint8_t TileClass(std::int64_t tile_x, std::int64_t tile_y) const {
    return tiles_[static_cast<std::size_t>(tile_y * tiles_x_ + tile_x)];
  }

  /// Tiles on every side of one, all of them of its class: a ray may step over as many.
  std::int64_t TileReach(std::int64_t tile_x, std::int64_t tile_y) const {
    return reach_[static_cast<std::size_t>(tile_y * tiles_x_ + tile_x)];
  }

  /// From the map's frame [m] to cells of the grid.
  Eigen::Vector2d ToCells(const Eigen::Vector2d& in_map_m) const {
    const double dx = in_map_m.x() - map_from_grid_.x, dy = in_map_m.y() - map_from_grid_.y;
    return {(cos_ * dx + sin_ * dy) * per_cell_, (cos_ * dy - sin_ * dx) * per_cell_};
  }

  /// How far a place is outside of the map [m]; 0 inside.
  double DistanceOutside(const Eigen::Vector2d& in_map_m) const;

 private:
  void Fill(const std::uint8_t* classes);
  void FindReach();

  double resolution_, per_cell_;
  PlanarPose map_from_grid_;
  double cos_, sin_;
  std::int64_t width_, height_, tiles_x_ = 0, tiles_y_ = 0;
  std::uint8_t outside_;
  int class_count_ = 1;
  std::vector<std::uint8_t> cells_;  // tile by tile, row by row
  std::vector<std::uint8_t> tiles_, reach_;
};

/// How far a ray goes through one class in one coarse cell.
struct RayPiece {
  std::int32_t x, y;       ///< the coarse cell [x, x + 1) x [y, y + 1), times its side, in the map
  std::uint32_t material;  ///< the class
  double length_m;         ///< along the ray, in space
};

/// Follows straight rays through a map (Amanatides and Woo 1987), and says how long they are in
/// each class of each coarse cell: the weights w_i of the thesis' equation 3.2.
///
/// Lengths are exact, in the cells of both ends too, and do not depend, by a single bit, on which
/// end is named first.  Parts outside of the map are of its outside class.  The coarse lattice
/// belongs to the map's frame, not to the grid, and so survives a map of another resolution,
/// origin or heading.  Cells are infinitely tall columns: a ray that climbs is longer by its slope.
///
/// Holds memory that it uses again: one tracer a thread.
class RayTracer {
 public:
  /// Without a map, everything is of class 0.  `coarse_m` 0: one coarse cell, (0, 0), that is
  /// everywhere.  The map must stay.
  RayTracer(const ClassMap* map, double coarse_m);

  /// The pieces along the ray, a pair of class and coarse cell once each, in the order of the
  /// coarse cells along the ray; none of ends that are at the same place.  The result is valid
  /// until the next call.  Ends must be finite.
  const std::vector<RayPiece>& Trace(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

  /// Cells of the map that the last ray crossed.
  std::int64_t CellsCrossed() const { return cells_crossed_; }

 private:
  struct Run {
    double end;  // of the whole ray 1
    std::uint8_t material;
  };
  void WalkMap(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m);
  void WalkCells(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double begin, double end);
  void WalkCoarse(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m, double length_m);
  void EndRun(double end, std::uint8_t material) {
    if (!runs_.empty() && runs_.back().material == material) {
      runs_.back().end = end;
    } else {
      runs_.push_back({end, material});
    }
  }
  void AddPieces(std::int32_t x, std::int32_t y, double length_m);

  const ClassMap* map_;
  double coarse_m_;
  int class_count_;
  std::int64_t cells_crossed_ = 0;
  std::vector<Run> runs_;
  std::vector<double> part_;  // of the ray, a class
  std::vector<RayPiece> pieces_;
};

}  // namespace graticule
