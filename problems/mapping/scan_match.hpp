#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/problems/mapping/likelihood_grid.hpp"

namespace graticule {

/// Where to look for a pose: a guess, how far from it, and how far it is believed.
struct SearchWindow {
  PlanarPose guess;             ///< reference_from_scan
  double reach = 0.3;           ///< m, to each side along x and y of the reference
  double reach_yaw = 0.2;       ///< rad, to each side
  double sigma = HUGE_VAL;      ///< m, of the guess, along x and y
  double sigma_yaw = HUGE_VAL;  ///< rad
};

struct Match {
  PlanarPose reference_from_scan;
  double score = 0;  ///< mean likelihood of the points there, 0 to 1
};

/// Correlative scan matching (Olson 2009, 2015): the pose at which a scan's points are most likely,
/// of all poses of a grid in a window.  Best first over a pyramid of upper bounds: what is found is
/// the best of the grid, not a local one.  Keeps its memory; one a thread.
class CorrelativeMatcher {
 public:
  /// What the points say counts this much against the guess, a point: they are not independent.
  static constexpr double kPointWeight = 0.3;

  /// The pose of the largest kPointWeight * sum of likelihoods - half the squared Mahalanobis
  /// distance to the guess.  False where no pose has a mean likelihood of `least_score`.
  bool Search(const LikelihoodGrid& grid, Span<const SurfacePoint> points,
              const SearchWindow& window, double least_score, Match* best);

  /// Covariance of [x y yaw] in the scan's frame from the correlation surface about a pose (Olson
  /// 2009, section IV.C): second moments of the likelihood, row by row.  Where the surface is flat
  /// over what is looked at (+-`cells` cells, and yaw alike) it says little more than that.
  std::array<double, 9> Covariance(const LikelihoodGrid& grid, Span<const SurfacePoint> points,
                                   const PlanarPose& pose, int cells = 4);

  std::size_t Visited() const { return visited_; }  ///< bounds computed by the last search

 private:
  struct Node {
    double bound;
    std::int32_t yaw, x, y, level;
  };
  static bool Worse(const Node& a, const Node& b);
  /// Below zero: less than `least`, by how much was not computed.
  double MeanBound(const LikelihoodGrid& grid, const Node& node, double least);
  double Penalty(const SearchWindow& window, const Node& node) const;
  void Rotate(const LikelihoodGrid& grid, Span<const SurfacePoint> points,
              const SearchWindow& window);

  std::vector<Node> heap_;
  std::vector<std::int32_t> cells_;  // x, y of each point at the window's corner, yaw by yaw
  std::size_t count_ = 0, visited_ = 0;
  std::int32_t half_ = 0, half_yaw_ = 0;
  double step_yaw_ = 0, cell_ = 0;
};

}  // namespace graticule
