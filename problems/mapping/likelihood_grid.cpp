#include "graticule/problems/mapping/likelihood_grid.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {

LikelihoodGrid::LikelihoodGrid(double cell, double sigma) : cell_(cell) {
  radius_ = static_cast<int>(std::ceil(2.5 * sigma / cell));
  for (int y = -radius_; y <= radius_; ++y)
    for (int x = -radius_; x <= radius_; ++x) {
      const double d = std::hypot(x, y) * cell / sigma;
      kernel_.push_back(static_cast<std::uint8_t>(std::lround(255 * std::exp(-d * d / 2))));
    }
}

void LikelihoodGrid::Build(Span<const SurfacePoint> points, double centre_x, double centre_y,
                           double reach) {
  double low_x = HUGE_VAL, low_y = HUGE_VAL, high_x = -HUGE_VAL, high_y = -HUGE_VAL;
  const auto is_near = [&](const SurfacePoint& p) {
    return std::abs(static_cast<double>(p.x) - centre_x) <= reach &&
           std::abs(static_cast<double>(p.y) - centre_y) <= reach;
  };
  for (const SurfacePoint& p : points) {
    if (!is_near(p)) continue;
    low_x = std::min(low_x, static_cast<double>(p.x));
    low_y = std::min(low_y, static_cast<double>(p.y));
    high_x = std::max(high_x, static_cast<double>(p.x));
    high_y = std::max(high_y, static_cast<double>(p.y));
  }
  if (low_x > high_x) low_x = high_x = centre_x, low_y = high_y = centre_y;
  // A block of the top level that begins left of the first point may hold it.
  const double before = (radius_ + (1 << kTopLevel) + 1) * cell_, after = (radius_ + 2) * cell_;
  origin_x_ = low_x - before;
  origin_y_ = low_y - before;
  Level& fine = levels_[0];
  fine.width = static_cast<int>((high_x + after - origin_x_) / cell_) + 1;
  fine.height = static_cast<int>((high_y + after - origin_y_) / cell_) + 1;
  fine.cells.assign(static_cast<std::size_t>(fine.width) * static_cast<std::size_t>(fine.height),
                    0);
  for (const SurfacePoint& p : points)
    if (is_near(p))
      Stamp(static_cast<int>((static_cast<double>(p.x) - origin_x_) / cell_),
            static_cast<int>((static_cast<double>(p.y) - origin_y_) / cell_));
  BuildPyramid();
}

void LikelihoodGrid::Stamp(int x, int y) {
  const std::size_t width = static_cast<std::size_t>(levels_[0].width);
  std::uint8_t* cells = levels_[0].cells.data();
  if (cells[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] == 255) return;
  const int side = 2 * radius_ + 1;
  for (int j = 0; j < side; ++j) {
    std::uint8_t* row = cells + static_cast<std::size_t>(y - radius_ + j) * width +
                        static_cast<std::size_t>(x - radius_);
    const std::uint8_t* kernel = kernel_.data() + static_cast<std::size_t>(j * side);
    for (int i = 0; i < side; ++i) row[i] = std::max(row[i], kernel[i]);
  }
}

// Level k at I holds the largest of [I 2^k, (I + 2) 2^k): twice the block, so that a block which
// begins anywhere in I is inside.  From level k - 1 that is the larger of 2 I and 2 I + 2; level 0
// holds single cells, so level 1 looks at four.
void LikelihoodGrid::BuildPyramid() {
  for (int k = 1; k <= kTopLevel; ++k) {
    const Level& below = levels_[k - 1];
    Level& level = levels_[k];
    level.width = below.width / 2 + 1;
    level.height = below.height / 2 + 1;
    const auto width = static_cast<std::size_t>(level.width);
    const auto width_below = static_cast<std::size_t>(below.width);
    level.cells.resize(width * static_cast<std::size_t>(level.height));
    const int reach = k == 1 ? 3 : 2, stride = k == 1 ? 1 : 2;
    row_.assign(2 * width + 4, 0);  // of the rows below, with nothing beyond their end
    for (int y = 0; y < level.height; ++y) {
      std::uint8_t* const merged = row_.data();
      std::fill_n(merged, width_below, std::uint8_t{0});
      for (int j = 2 * y; j <= std::min(2 * y + reach, below.height - 1); j += stride) {
        const std::uint8_t* from = below.cells.data() + static_cast<std::size_t>(j) * width_below;
        for (std::size_t i = 0; i < width_below; ++i) merged[i] = std::max(merged[i], from[i]);
      }
      std::uint8_t* to = level.cells.data() + static_cast<std::size_t>(y) * width;
      const std::uint8_t* const row = merged;
      if (k == 1)
        for (std::size_t x = 0; x < width; ++x)
          to[x] = std::max(std::max(row[2 * x], row[2 * x + 1]),
                           std::max(row[2 * x + 2], row[2 * x + 3]));
      else
        for (std::size_t x = 0; x < width; ++x) to[x] = std::max(row[2 * x], row[2 * x + 2]);
    }
  }
}

}  // namespace graticule
