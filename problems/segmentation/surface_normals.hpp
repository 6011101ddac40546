#pragma once

#include <vector>

#include "graticule/problems/segmentation/scan_mesh.hpp"

namespace graticule {

/// Unit normals of the surface at each point, towards the sensor: the direction of least spread of
/// the points in a window of the grid around it (thesis section 4.2, "PlanePCA").
///
/// Of a window of 2 r + 1 rows and columns those points count that are reached from its middle by
/// unbroken links, first along the column, then along the row: the window ends where the surface
/// does.  With r = 1 that is the thesis' neighbourhood of 8, and the point itself.
class SurfaceNormals {
 public:
  /// `radius` is r above, 1 to kLargestRadius.
  void Compute(const ScanMesh& mesh, int radius);
  static constexpr int kLargestRadius = 16;

  /// The same while a mesh grows: Extend after each of its rows finds the normals of those whose
  /// windows are there, which is `radius` rows late; Finish finds the last ones.
  void Begin(std::size_t width, int radius);
  void Extend(const ScanMesh& mesh);
  void Finish(const ScanMesh& mesh);
  /// Rows whose normals are known.
  std::size_t Rows() const { return rows_; }

  /// Components, a list each; all zero where fewer than three points or a line of points are
  /// linked.
  const float* X() const { return x_.data(); }
  const float* Y() const { return y_.data(); }
  const float* Z() const { return z_.data(); }
  /// Spread across the surface, rms of the window's points [m].
  const float* Roughness() const { return roughness_.data(); }

 private:
  void FitUntil(const ScanMesh& mesh, std::size_t end);
  void SumRow(const ScanMesh& mesh, std::size_t row, float* sums);
  void SumColumns(const ScanMesh& mesh, std::size_t row);
  void FitRow(const ScanMesh& mesh, std::size_t row);

  int radius_ = 1;
  std::size_t rows_ = 0, summed_ = 0;
  std::vector<float> x_, y_, z_, roughness_;
  std::vector<float> row_sums_;  // of the rows that a window covers, kMoments lists each
  std::vector<float> sums_;      // of the windows of a row
  std::vector<float> reach_;     // 1 where the walk goes on, else 0
};

/// The unit normal of one symmetric matrix [xx xy xz yy yz zz], by a general eigen-solver: what
/// Compute agrees with, slower.
Eigen::Vector3f LeastDirection(const float* covariance);

}  // namespace graticule
