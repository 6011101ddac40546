#pragma once

#include <cstdint>
#include <vector>

#include "graticule/problems/segmentation/edge_weights.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {

struct GraphSegmentationOptions {
  /// Equation 4.3, of colour [units of 0 to 255, times points] and of normals [rad, times points].
  double k_colour = 9000, k_normal = 10;
  /// Segments of fewer points are joined to a neighbour, the most alike first.
  std::size_t min_size = 100;
};

/// Algorithm 4.1: edges in increasing order of weight; an edge joins two segments where both of its
/// weights are below both thresholds of both, and the thresholds follow by Equation 4.3 (after
/// Felzenszwalb and Huttenlocher 2004).
///
/// Union-find with path halving and union by size: O(n alpha(n)).  Memory is kept from frame to
/// frame.
class GraphSegmentation {
 public:
  void Segment(const ScanMesh& mesh, const std::vector<WeighedEdge>& edges,
               const GraphSegmentationOptions& options);

  /// Of each point its segment, 1 to Count() in the order of their first points; 0: a point without
  /// any link.
  const std::vector<std::uint32_t>& Labels() const { return labels_; }
  std::size_t Count() const { return count_; }

 private:
  struct Segment_ {
    float colour, angle;  // thresholds, in steps
    std::uint32_t size;
  };
  std::uint32_t Join(std::uint32_t a, std::uint32_t b);
  void Relabel(const ScanMesh& mesh);

  UnionFind sets_;
  std::vector<std::uint32_t> labels_, names_;
  std::vector<Segment_> segments_;
  std::vector<std::uint64_t> refused_;  // both ends of edges between segments
  std::size_t count_ = 0;
};

}  // namespace graticule
