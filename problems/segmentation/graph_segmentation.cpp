#include "graticule/problems/segmentation/graph_segmentation.hpp"

#include <algorithm>
#include <tuple>

namespace graticule {
namespace {

constexpr float kAngleStepsARad = EdgeWeights::kAngleSteps / 3.14159265358979f;

}  // namespace

std::uint32_t GraphSegmentation::Join(std::uint32_t a, std::uint32_t b) {
  if (segments_[a].size < segments_[b].size) std::swap(a, b);
  sets_.Hang(b, a);
  segments_[a].size += segments_[b].size;
  return a;
}

void GraphSegmentation::Segment(const ScanMesh& mesh, const std::vector<WeighedEdge>& edges,
                                const GraphSegmentationOptions& options) {
  const std::size_t n = mesh.Size();
  const float k_colour = static_cast<float>(options.k_colour * EdgeWeights::kColourSteps);
  const float k_angle = static_cast<float>(options.k_normal) * kAngleStepsARad;
  sets_.Reset(n);
  segments_.assign(n, {k_colour, k_angle, 1});
  refused_.clear();
  const std::uint32_t seam = static_cast<std::uint32_t>(ScanMesh::kDirections * n);
  for (const WeighedEdge& edge : edges) {
    std::uint32_t i, j;
    if (edge.code < seam) {
      i = edge.code >> 2;
      j = i + static_cast<std::uint32_t>(mesh.Step(static_cast<int>(edge.code & 3)));
    } else {
      std::tie(i, j) = mesh.Seam()[edge.code - seam];
    }
    const std::uint32_t a = sets_.Root(i), b = sets_.Root(j);
    if (a == b) continue;
    const Segment_ &p = segments_[a], &q = segments_[b];
    const float colour = edge.colour, angle = edge.angle;
    if (colour < std::min(p.colour, q.colour) && angle < std::min(p.angle, q.angle)) {
      Segment_& joined = segments_[Join(a, b)];
      const float share = 1 / static_cast<float>(joined.size);
      joined.colour = colour + k_colour * share;
      joined.angle = angle + k_angle * share;
    } else {
      refused_.push_back(std::uint64_t{a} << 32 | b);
    }
  }
  if (options.min_size > 1)
    for (const std::uint64_t ends : refused_) {
      const std::uint32_t a = sets_.Root(static_cast<std::uint32_t>(ends >> 32));
      const std::uint32_t b = sets_.Root(static_cast<std::uint32_t>(ends));
      if (a != b && std::min(segments_[a].size, segments_[b].size) < options.min_size) Join(a, b);
    }
  Relabel(mesh);
}

void GraphSegmentation::Relabel(const ScanMesh& mesh) {
  const std::size_t n = mesh.Size();
  labels_.resize(n);
  names_.assign(n, 0);
  count_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t root = sets_.Root(static_cast<std::uint32_t>(i));
    if (segments_[root].size == 1) {
      labels_[i] = 0;
      continue;
    }
    if (names_[root] == 0) names_[root] = static_cast<std::uint32_t>(++count_);
    labels_[i] = names_[root];
  }
}

}  // namespace graticule
