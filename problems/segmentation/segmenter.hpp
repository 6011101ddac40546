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
#include "graticule/solver/span.hpp"

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
/// overlap (docs/segmentation.md).  The mesh of a LIDAR that turns (PointCloud::is_spinning) is
/// closed, and its links may be longer and flatter: it sees the ground far ahead, flatly, and its
/// beams are far apart there.
SegmentOptions DefaultsOf(SegmentMethod method, bool is_spinning = false);

/// Segments organised clouds, frame after frame: nothing is allocated after the first of a size.
///
/// A cloud is given whole, or scan by scan as a laser takes them: Begin, AddScan for each, Finish.
/// Of a scan that is added the links to the one before are found at once, normals `normal_radius`
/// scans later, and weights one scan after that; what needs all edges, Algorithm 4.1 itself, is
/// left to Finish.
///
/// Deterministic: the same points, the same labels, either way.  Not for several threads at once;
/// one a thread.
class Segmenter {
 public:
  explicit Segmenter(const SegmentOptions& options) : options_(options) {}

  /// Of each point its segment, 1 to SegmentCount() in the order of their first points; 0: no
  /// return, or none that is linked to another.  Valid until the next call.  Throws Error (kInput):
  /// not organised, no point, no colours where the method asks for them.
  const std::vector<std::uint32_t>& Segment(const PointCloud& cloud);

  /// A cloud whose scans have `width` points each; what was begun before is forgotten.
  void Begin(std::size_t width);
  /// The next scan: points in the sensor's frame [m], not finite where there was no return, and
  /// their colours; empty where the method does not ask for them.  Nothing is kept of the lists.
  /// Throws Error (kUsage): not `width` of them, or nothing was begun.
  void AddScan(Span<const Eigen::Vector3f> points, Span<const Rgb> colours = {});
  /// Labels as Segment's.  Throws Error (kInput): fewer than two scans.
  const std::vector<std::uint32_t>& Finish();

  std::size_t SegmentCount() const;
  /// Of the scans so far; normals of Normals().Rows() of them.
  const ScanMesh& Mesh() const { return mesh_; }
  const SurfaceNormals& Normals() const { return normals_; }

 private:
  bool ByColour() const;
  bool ByNormals() const {
    return options_.method != SegmentMethod::kColour && options_.method != SegmentMethod::kImage;
  }
  void Add(const Eigen::Vector3f* points, const Rgb* colours);

  SegmentOptions options_;
  std::size_t width_ = 0;  // of the scans that are being added; 0: Begin comes next
  ScanMesh mesh_;
  SurfaceNormals normals_;
  EdgeWeights weights_;
  GraphSegmentation graph_;
  ConvexMerge convex_;
};

}  // namespace graticule
