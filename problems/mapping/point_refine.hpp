#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graticule/problems/mapping/surface_points.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// Points with normals, found by where they are.
class PointIndex {
 public:
  static constexpr double kCell = 0.2;  ///< m; nothing farther than this is found

  void Build(Span<const SurfacePoint> points);

  /// The nearest point within `reach` (at most kCell) whose normal agrees; null if there is none.
  const SurfacePoint* Nearest(float x, float y, float nx, float ny, float reach) const;

 private:
  std::vector<SurfacePoint> sorted_;
  std::vector<std::uint32_t> first_;  // of each cell, in sorted_
  std::vector<std::uint32_t> cell_of_;
  float origin_x_ = 0, origin_y_ = 0;
  int width_ = 0, height_ = 0;
};

struct RefineOptions {
  int max_iterations = 12;
  double reach = 0.2;   ///< m; correspondences are no longer than this at first
  double scale = 0.03;  ///< m; residuals of more than about this count less (Cauchy)
};

struct Refinement {
  PlanarPose reference_from_scan;
  /// Of [x y yaw] in the scan's frame, per unit variance of a residual, without the prior.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double rms = 0;          ///< m, of the residuals, weighted
  double matched = 0;      ///< share of the scan's points that have a correspondence
  std::size_t points = 0;  ///< with a correspondence
};

/// The pose that minimises the distances of a scan's points to the lines of their nearest
/// neighbours (Gauss-Newton, reweighted), and half of d' P d, with d the pose's distance from the
/// guess in the scan's frame there and P `prior`.  Starts at the guess.  `residual_sigma` [m]
/// weighs the two against each other.
Refinement RefineOnPoints(const PointIndex& reference, Span<const SurfacePoint> scan,
                          const PlanarPose& start, const PlanarPose& guess,
                          const Eigen::Matrix3d& prior, double residual_sigma,
                          const RefineOptions& options = {});

}  // namespace graticule
