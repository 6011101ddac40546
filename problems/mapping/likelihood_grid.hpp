#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/problems/mapping/surface_points.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// How likely a beam is to end in each cell of a grid, given points that others ended at: 255 at a
/// point, falling off as a normal distribution.  With a pyramid of maxima above it, after Olson
/// ("Real-time correlative scan matching", ICRA 2009; "M3RSM: Many-to-many multi-resolution scan
/// matching", ICRA 2015).  Memory is kept from one Build to the next.
class LikelihoodGrid {
 public:
  static constexpr int kTopLevel = 5;

  /// `sigma` is that of the fall-off; both in metres.
  LikelihoodGrid(double cell, double sigma);

  /// Of points no farther than `reach` from a centre.
  void Build(Span<const SurfacePoint> points, double centre_x, double centre_y, double reach);

  /// 0 to 255.  Level k at (x >> k, y >> k): no less than any cell of [x, x + 2^k) x [y, y + 2^k).
  int At(int level, int x, int y) const {
    const Level& at = levels_[static_cast<std::size_t>(level)];
    if (static_cast<unsigned>(x) >= static_cast<unsigned>(at.width) ||
        static_cast<unsigned>(y) >= static_cast<unsigned>(at.height))
      return 0;
    return at.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(at.width) +
                    static_cast<std::size_t>(x)];
  }

  double Cell() const { return cell_; }
  /// Where cell (0, 0) begins.
  double OriginX() const { return origin_x_; }
  double OriginY() const { return origin_y_; }

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<std::uint8_t> cells;
  };

  void Stamp(int x, int y);
  void BuildPyramid();

  double cell_;
  double origin_x_ = 0, origin_y_ = 0;
  int radius_ = 0;
  std::vector<std::uint8_t> kernel_;
  Level levels_[kTopLevel + 1];
  std::vector<std::uint8_t> row_;
};

}  // namespace graticule
