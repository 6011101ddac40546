#pragma once

#include <cstdint>
#include <vector>

#include "graticule/problems/mapping/cell_bits.hpp"
#include "graticule/problems/mapping/scan_points.hpp"

namespace graticule {

/// What one scan says of a tile's cells.  No cell is both.
struct ScanTile {
  TileIndex index;
  CellBits passed;  ///< crossed by a beam, hit by none
  CellBits hit;     ///< a beam ended here
};

/// Calls f(a's tile, b's tile) for each tile that is not the same in both, in order; where one has
/// none, an empty one stands for it.
template <class F>
void ForEachDifference(const std::vector<ScanTile>& a, const std::vector<ScanTile>& b, F f) {
  auto in_a = a.begin(), in_b = b.begin();
  while (in_a != a.end() || in_b != b.end()) {
    if (in_b == b.end() || (in_a != a.end() && in_a->index < in_b->index)) {
      f(*in_a, ScanTile{in_a->index, {}, {}});
      ++in_a;
    } else if (in_a == a.end() || in_b->index < in_a->index) {
      f(ScanTile{in_b->index, {}, {}}, *in_b);
      ++in_b;
    } else {
      if (in_a->passed != in_b->passed || in_a->hit != in_b->hit) f(*in_a, *in_b);
      ++in_a;
      ++in_b;
    }
  }
}

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
  struct Canvas;
  void PlaceBeams(const ScanPoints& points, const PlanarPose& world_from_robot);
  void DrawFan(const Canvas& canvas, const Beam* begin, const Beam* end) const;
  void Collect(std::vector<ScanTile>* tiles);

  double cells_per_metre_;
  // The window: rows of `columns_` words of 64 cells, from the bottom; empty between calls.
  std::int32_t left_ = 0, bottom_ = 0, columns_ = 0, height_ = 0;
  std::vector<std::uint64_t> passed_, hit_;
  std::int64_t start_x_ = 0;
  std::int32_t start_row_ = 0;
  std::vector<double> end_x_, end_y_;
  std::vector<Beam> beams_;
};

}  // namespace graticule
