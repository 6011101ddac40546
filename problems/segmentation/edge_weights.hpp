#pragma once

#include <cstdint>
#include <vector>

#include "graticule/problems/segmentation/scan_mesh.hpp"
#include "graticule/problems/segmentation/surface_normals.hpp"

namespace graticule {

/// What an edge is sorted by.
enum class EdgeOrder { kColour, kAngle };

/// An edge of a mesh with both of its weights, in discrete steps.
struct WeighedEdge {
  std::uint32_t code;    ///< 4 i + direction; from 4 n on, a link of the seam
  std::uint16_t colour;  ///< Equation 4.4, in steps of 1 / kColourSteps
  std::uint16_t angle;   ///< Equation 4.5, in steps of pi / kAngleSteps rad
};

/// The edges of a mesh, weighed by colour (Equation 4.4) and by the angle between normals
/// (Equation 4.5), in increasing order of one of them.
///
/// Counting sort: O(n + k), stable, so that edges of one weight stay in the mesh's order.  Memory
/// is kept from frame to frame.
class EdgeWeights {
 public:
  static constexpr int kColourSteps = 16;   ///< a unit of a colour's 0 to 255
  static constexpr int kAngleSteps = 8192;  ///< half a turn

  /// `colours` may be null: every colour weight is then zero; `normals` too.
  void Compute(const ScanMesh& mesh, const Rgb* colours, const SurfaceNormals* normals,
               EdgeOrder order);

  /// The same while a mesh grows: AddColours with each of its rows (or with none), then Extend
  /// weighs the edges of points of which both ends are known; Finish weighs the last ones, and
  /// sorts.
  void Begin(EdgeOrder order);
  void AddColours(const Rgb* row, std::size_t width);
  void Extend(const ScanMesh& mesh, const SurfaceNormals* normals);
  void Finish(const ScanMesh& mesh, const SurfaceNormals* normals);

  const std::vector<WeighedEdge>& Sorted() const { return sorted_; }

 private:
  void WeighUntil(const ScanMesh& mesh, const SurfaceNormals* normals, std::size_t end);
  void WeighRow(const ScanMesh& mesh, const SurfaceNormals* normals, int directions);
  void WeighSeam(const ScanMesh& mesh, const SurfaceNormals* normals);
  void Count(const ScanMesh& mesh);
  void Sort(const ScanMesh& mesh);

  EdgeOrder order_ = EdgeOrder::kColour;
  std::size_t rows_ = 0;  // whose edges are weighed
  std::vector<std::uint8_t> red_, green_, blue_;
  std::vector<std::uint16_t> colour_, angle_;            // a row after the other, by directions
  std::vector<std::uint16_t> seam_colour_, seam_angle_;  // of the seam's links
  std::vector<std::uint32_t> first_;                     // of each weight, in the sorted list
  std::vector<WeighedEdge> sorted_;
};

}  // namespace graticule
