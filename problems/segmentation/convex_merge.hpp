#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "graticule/problems/segmentation/scan_mesh.hpp"
#include "graticule/problems/segmentation/surface_normals.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {

struct ConvexMergeOptions {
  std::size_t block = 5;  ///< a patch is within a square of this many rows and columns, 2 to 16
  double patch_angle_rad = 0.22;    ///< between linked normals of a patch, at most
  std::size_t patch_points = 5;     ///< smaller patches are shared out among their neighbours
  double concave_angle_rad = 0.33;  ///< a concave edge up to this angle still joins
  std::size_t min_links = 4;        ///< between two patches that are neighbours
  /// Segments of fewer points are joined to the largest neighbour.
  std::size_t min_size = 200;
};

/// Objects are what is convex: small patches of surface are joined across convex edges, and parted
/// where one surface stands on another (Stein, Schoeler, Papon, Woergoetter 2014: "Object
/// partitioning using local convexity", on a mesh in place of supervoxels).
///
/// Patches: within each block of the grid, what is connected by links between like normals (the
/// criterion of Algorithm 4.1 with a fixed threshold).  Two neighbours are joined where the edge
/// between their mean planes is convex or nearly flat (their Equations 3 and 4), and where they
/// meet along an edge, not just at a corner (their "sanity criterion", Equation 5).  O(n); memory
/// is kept from frame to frame.
class ConvexMerge {
 public:
  void Segment(const ScanMesh& mesh, const SurfaceNormals& normals,
               const ConvexMergeOptions& options);

  /// Of each point its segment, 1 to Count() in the order of their first points; 0: none.
  const std::vector<std::uint32_t>& Labels() const { return labels_; }
  std::size_t Count() const { return count_; }
  std::size_t PatchCount() const { return patches_.size(); }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::size_t kLargestBlock = 16;
  struct Patch {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< [m]
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    std::uint32_t points = 0;
  };
  struct Border {
    std::uint32_t a, b, links;
  };

  void MakePatches(const ScanMesh& mesh, const SurfaceNormals& normals,
                   const ConvexMergeOptions& options);
  void MakeBlock(const ScanMesh& mesh, const SurfaceNormals& normals, std::size_t row,
                 std::size_t column, const ConvexMergeOptions& options, float least_cosine);
  void ShareOut(const ScanMesh& mesh);
  void FindBorders(const ScanMesh& mesh);
  void AddBorder(std::uint32_t a, std::uint32_t b);
  /// The table's slot that has the border of a and b, or the free one where it belongs.
  std::size_t SlotOf(std::uint32_t a, std::uint32_t b) const;
  bool IsJoined(const Border& border, const ConvexMergeOptions& options) const;
  void JoinSmall(const ConvexMergeOptions& options);
  void Relabel();

  std::vector<std::uint32_t> patch_of_;  // a point's
  std::vector<std::uint32_t> loose_;     // points without a patch
  std::vector<Patch> patches_;
  std::vector<Border> borders_;
  std::vector<std::uint32_t> table_;  // where in borders_, by hash
  UnionFind sets_;                    // of patches
  std::vector<std::uint32_t> sizes_, best_, labels_, names_;
  std::size_t count_ = 0;
};

}  // namespace graticule
