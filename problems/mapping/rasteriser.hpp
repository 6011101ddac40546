#pragma once

#include <cstdint>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/problems/mapping/cell_bits.hpp"

namespace graticule {

/// What one scan says of a tile's cells.  No cell is both.
struct ScanTile {
  TileIndex index;
  CellBits passed;  ///< crossed by a beam, hit by none
  CellBits hit;     ///< a beam ended here
};

/// A sweep's beams that say something, in the robot's frame.
struct ScanPoints {
  float laser_x = 0, laser_y = 0;  ///< m: where the beams begin
  std::vector<float> x, y;         ///< m: where they end, in the order of their angles
  std::vector<std::uint8_t> hit;   ///< whether something was there
  double reach = 0;                ///< m, from the robot's origin to the farthest of these places

  std::size_t Size() const { return x.size(); }
};

/// Which readings count, and how far.
struct RangeUse {
  /// m; a longer beam passes what lies nearer, and hits nothing.
  double max_range = 25;
  /// Whether a beam that did not return passes the cells up to max_range.  Off: dark and slanting
  /// surfaces and glass do not return either, and would be cleared away.
  bool clear_no_return = false;
};

/// Readings that are NaN, infinite, zero, negative, or at least geometry.max_range ("no return")
/// say nothing, but see RangeUse.  Throws Error: a geometry that is not finite.
ScanPoints MakeScanPoints(const LaserGeometry& geometry, Span<const float> ranges,
                          const RangeUse& use);

/// Draws scans into the lattice: every cell that a beam crosses is passed, the cell that it ends in
/// is hit, and a hit outweighs what other beams of the scan pass there.  Integer arithmetic, row by
/// row: a beam crosses a row of cells in one run; neighbouring beams that still cross
/// the same rows without a gap are drawn in one go, with the same result.
///
/// Not for two threads at once: it has working memory.
class Rasteriser {
 public:
  explicit Rasteriser(double resolution) : cells_per_metre_(1 / resolution) {}

  /// The tiles that the scan touches, in order.  What `tiles` held is replaced.  Every place must
  /// be within kMaxCell of the origin.
  void Draw(const ScanPoints& points, const PlanarPose& world_from_robot,
            std::vector<ScanTile>* tiles);

  static constexpr double kMaxCell = 1 << 28;

 private:
  struct Beam {
    std::int64_t first;  // 2^-32 cells: x where the beam leaves its first row
    std::int64_t slope;  // 2^-32 cells a row
    std::int64_t end_x;  // 2^-32 cells
    std::int32_t rows;   // crossed before the one it ends in
    bool up;
  };
  void PlaceBeams(const ScanPoints& points, const PlanarPose& world_from_robot);
  void DrawGroup(const Beam* begin, const Beam* end);
  void DrawRun(std::int32_t row, std::int64_t from, std::int64_t to);
  void Collect(std::vector<ScanTile>* tiles);

  double cells_per_metre_;
  // The window: columns of 64 cells, each `height_` words from the bottom; empty between calls.
  std::int32_t left_ = 0, bottom_ = 0, columns_ = 0, height_ = 0;
  std::vector<std::uint64_t> passed_, hit_;
  std::int64_t start_x_ = 0;
  std::int32_t start_row_ = 0;
  std::vector<double> end_x_, end_y_;
  std::vector<Beam> beams_;
};

}  // namespace graticule
