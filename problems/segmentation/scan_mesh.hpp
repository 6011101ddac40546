#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "graticule/io/cloud.hpp"

namespace graticule {

struct MeshOptions {
  /// Longer edges are cut [m] (thesis section 4.2: 0.25).
  double edge_cut_m = 0.25;
  /// Edges at less than this angle to the ray through their middle are cut [rad]: they jump from
  /// what is in front to what is behind.  Needs no length, and so suits any range; 0: none are.
  double grazing_rad = 0;
  /// The last column of the grid neighbours the first: a LIDAR that turns all around.
  bool is_closed = false;
};

/// Throws Error (kInput): no point, or no rows.
void ExpectOrganised(const PointCloud& cloud);

/// A surface through an organised cloud: every point may be linked to its 8 neighbours in the scan
/// before, its own, and the next (thesis section 4.2).
///
/// Of each point only the links to later points are kept, a bit each.  Memory is kept from frame to
/// frame.
class ScanMesh {
 public:
  /// To the point on the right, below on the left, below, below on the right.
  enum Direction { kRight, kDownLeft, kDown, kDownRight, kDirections };

  /// Throws Error (kInput): the cloud is not organised, or is empty.
  void Build(const PointCloud& cloud, const MeshOptions& options);

  /// The same, one scan after another: a mesh of no scan yet, and then `width` points each.  A
  /// point's links to the next scan are there when that one is.
  void Begin(std::size_t width, const MeshOptions& options);
  void AddRow(const Eigen::Vector3f* points);
  /// A row of a picture's grid: every link is there, and no point has a place.
  void AddGridRow();

  std::size_t Width() const { return width_; }
  std::size_t Height() const { return height_; }
  std::size_t Size() const { return width_ * height_; }
  /// Bit d: linked in Direction d.
  const std::uint8_t* Links() const { return links_.data(); }
  /// What is added to a point's place to get its neighbour's in a direction.
  std::ptrdiff_t Step(int direction) const { return steps_[direction]; }
  /// Links around the seam of a closed grid.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& Seam() const { return seam_; }
  std::size_t EdgeCount() const;
  /// Coordinates, a list each [m]; kNowhere where there was no return: far from everything, so that
  /// no link leads there, and finite, so that a weight of zero takes it out of a sum.
  static constexpr float kNowhere = 1e18f;
  const float* X() const { return x_.data(); }
  const float* Y() const { return y_.data(); }
  const float* Z() const { return z_.data(); }

 private:
  struct Cuts {
    float longest2 = 0;     // m^2
    float cos2 = 0;         // of the grazing angle
    bool is_round = false;  // the last column neighbours the first
  };
  static bool IsLink(float px, float py, float pz, float qx, float qy, float qz, const Cuts& cuts);
  void Link(std::size_t first, std::size_t count, Direction direction);
  void LinkSeam(std::size_t p, std::size_t q);
  void AddEmptyRow();

  std::size_t width_ = 0, height_ = 0;
  Cuts cuts_;
  std::ptrdiff_t steps_[kDirections] = {};
  std::vector<float> x_, y_, z_;
  std::vector<std::uint8_t> links_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> seam_;
};

}  // namespace graticule
