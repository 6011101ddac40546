#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "graticule/io/cloud.hpp"
#include "graticule/problems/segmentation/convex_merge.hpp"
#include "graticule/problems/segmentation/edge_weights.hpp"
#include "graticule/problems/segmentation/graph_segmentation.hpp"
#include "graticule/problems/segmentation/scan_mesh.hpp"
#include "graticule/problems/segmentation/surface_normals.hpp"

namespace graticule {

/// What parts one segment from the next.
enum class SegmentMethod {
  kConvex,   ///< concave edges of the surface (beyond the thesis)
  kJoint,    ///< colour and normals: Algorithm 4.1
  kColour,   ///< Algorithm 4.1 with colour alone
  kNormals,  ///< Algorithm 4.1 with normals alone
  kImage,    ///< colour alone, on the grid without its geometry (Felzenszwalb and Huttenlocher)
};

/// "convex", "joint", "colour", "normals", "image".  Throws Error (kUsage).
SegmentMethod SegmentMethodOf(std::string_view name);

/// All that the methods ask for; DefaultsOf has what suits each.
struct SegmentOptions {
  SegmentMethod method = SegmentMethod::kConvex;
  MeshOptions mesh;
  int normal_radius = 2;  ///< of SurfaceNormals' window
  GraphSegmentationOptions graph;
  ConvexMergeOptions convex;
};

/// Chosen on the labelled scenes of mosd/learn, by the mean of objects' F-scores and weighted
/// overlap (docs/segmentation.md).
SegmentOptions DefaultsOf(SegmentMethod method);

/// Segments organised clouds, frame after frame: nothing is allocated after the first of a size.
///
/// Deterministic: the same cloud, the same labels.  Not for several threads at once; one a thread.
class Segmenter {
 public:
  explicit Segmenter(const SegmentOptions& options) : options_(options) {}

  /// Of each point its segment, 1 to SegmentCount() in the order of their first points; 0: no
  /// return, or none that is linked to another.  Valid until the next call.  Throws Error (kInput):
  /// not organised, no point, no colours where the method asks for them.
  const std::vector<std::uint32_t>& Segment(const PointCloud& cloud);

  std::size_t SegmentCount() const;
  const ScanMesh& Mesh() const { return mesh_; }
  const SurfaceNormals& Normals() const { return normals_; }

 private:
  SegmentOptions options_;
  ScanMesh mesh_;
  SurfaceNormals normals_;
  EdgeWeights weights_;
  GraphSegmentation graph_;
  ConvexMerge convex_;
};

}  // namespace graticule
