#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "graticule/problems/pose_graph/neighbours.hpp"
#include "graticule/problems/random.hpp"

namespace graticule {

/// Draws pairs of poses that are near each other, for closures.  Poses begin with x and y [m].
struct PairDraw {
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  ///< later pose, earlier pose

  const std::vector<std::array<double, 7>>& poses;
  double range_m;
  RandomNumbers* random;

  /// That many different pairs, each within the range and of poses that `fits(a, b)`, in the order
  /// of the later pose.  Fewer where a round of drawing finds less than one in twenty of what is
  /// missing.  `near(i)` are the poses that pose i may be paired with.
  template <class Near, class Fits>
  std::vector<Pair> Pairs(std::size_t wanted, Near near, Fits fits) const {
    constexpr std::size_t kFew = 200;
    std::vector<Pair> pairs;
    std::vector<std::size_t> drawn;
    while (pairs.size() < wanted) {
      const std::size_t before = pairs.size(), missing = wanted - before;
      drawn.resize(std::max(missing, kFew));
      for (std::size_t& pose : drawn) pose = random->Below(poses.size());
      // Many in order: neighbours in time are neighbours in memory.  Few as drawn: not all are
      // used.
      if (drawn.size() > kFew) std::sort(drawn.begin(), drawn.end());
      for (const std::size_t i : drawn) {
        if (pairs.size() == wanted) break;
        const std::size_t other = One(near(i), i, fits);
        if (other != i)
          pairs.emplace_back(static_cast<std::uint32_t>(std::max(i, other)),
                             static_cast<std::uint32_t>(std::min(i, other)));
      }
      const auto fresh = pairs.begin() + static_cast<std::ptrdiff_t>(before);
      std::sort(fresh, pairs.end());
      std::inplace_merge(pairs.begin(), fresh, pairs.end());
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
      if (20 * (pairs.size() - before) < missing) break;
    }
    return pairs;
  }

 private:
  // A pose near pose i that fits, i itself if none was found in some tries.
  template <class Fits>
  std::size_t One(const Neighbours& near, std::size_t i, Fits fits) const {
    std::array<std::pair<std::uint32_t, std::uint32_t>, 9> cells;
    std::size_t cell_count = 0, entries = 0;
    near.Around(poses[i][0], poses[i][1], [&](std::uint32_t first, std::uint32_t last) {
      cells[cell_count++] = {first, last};
      entries += last - first;
    });
    constexpr int kTries = 16;
    for (int attempt = 0; attempt < kTries && entries > 0; ++attempt) {
      std::size_t entry = random->Below(entries);
      std::size_t cell = 0;
      while (entry >= cells[cell].second - cells[cell].first)
        entry -= cells[cell].second - cells[cell].first, ++cell;
      const std::size_t other = near.At(cells[cell].first + entry);
      const double dx = poses[i][0] - poses[other][0], dy = poses[i][1] - poses[other][1];
      if (std::hypot(dx, dy) <= range_m && other != i && fits(other, i)) return other;
    }
    return i;
  }
};

}  // namespace graticule
