#include "graticule/problems/segmentation/edge_weights.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/segmentation/wide_loop.hpp"

namespace graticule {
namespace {

constexpr float kPi = 3.14159265358979f;
constexpr std::size_t kColourBins = 442 * EdgeWeights::kColourSteps;  // sqrt(3) 255 < 442
constexpr std::size_t kAngleBins = EdgeWeights::kAngleSteps + 1;

GRATICULE_WIDE inline std::uint16_t ColourWeight(int dr, int dg, int db) {
  const float squared = static_cast<float>(dr * dr + dg * dg + db * db);
  return static_cast<std::uint16_t>(
      static_cast<int>(std::sqrt(squared) * EdgeWeights::kColourSteps));
}

// Abramowitz and Stegun 4.4.45, within 7e-5 rad; of a point without a normal, none.
GRATICULE_WIDE inline std::uint16_t AngleWeight(float dot) {
  const float x = std::min(std::fabs(dot), 1.0f);
  const float sharp =
      std::sqrt(1 - x) * (1.5707288f + x * (-0.2121144f + x * (0.0742610f - x * 0.0187293f)));
  const float angle = dot < 0 ? kPi - sharp : sharp;
  const float steps = angle * (EdgeWeights::kAngleSteps / kPi);
  return static_cast<std::uint16_t>(static_cast<int>(steps + 0.5f));
}

}  // namespace

void EdgeWeights::WeighColours(const ScanMesh& mesh, const Rgb* colours) {
  const std::size_t n = mesh.Size();
  red_.resize(n);
  green_.resize(n);
  blue_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    red_[i] = colours[i][0];
    green_[i] = colours[i][1];
    blue_[i] = colours[i][2];
  }
  const auto weigh = [&](std::size_t i, std::size_t j) {
    return ColourWeight(red_[j] - red_[i], green_[j] - green_[i], blue_[j] - blue_[i]);
  };
  for (int d = 0; d < ScanMesh::kDirections; ++d) {
    const std::size_t step = static_cast<std::size_t>(mesh.Step(d));
    std::uint16_t* to = &colour_[static_cast<std::size_t>(d) * n];
    const std::uint8_t *r = red_.data(), *g = green_.data(), *b = blue_.data();
    RunWide([=]() GRATICULE_WIDE {
#pragma GCC ivdep
      for (std::size_t i = 0; i < n - std::min(n, step); ++i)
        to[i] = ColourWeight(r[i + step] - r[i], g[i + step] - g[i], b[i + step] - b[i]);
    });
  }
  std::size_t k = ScanMesh::kDirections * n;
  for (const auto& [i, j] : mesh.Seam()) colour_[k++] = weigh(i, j);
}

void EdgeWeights::WeighAngles(const ScanMesh& mesh, const SurfaceNormals& normals) {
  const std::size_t n = mesh.Size();
  const float *x = normals.X(), *y = normals.Y(), *z = normals.Z();
  const auto weigh = [&](std::size_t i, std::size_t j) {
    const float dot = x[i] * x[j] + y[i] * y[j] + z[i] * z[j];
    return dot == 0 ? std::uint16_t{0} : AngleWeight(dot);
  };
  for (int d = 0; d < ScanMesh::kDirections; ++d) {
    const std::size_t step = static_cast<std::size_t>(mesh.Step(d));
    std::uint16_t* to = &angle_[static_cast<std::size_t>(d) * n];
    RunWide([=]() GRATICULE_WIDE {
#pragma GCC ivdep
      for (std::size_t i = 0; i < n - std::min(n, step); ++i) {
        const float dot = x[i] * x[i + step] + y[i] * y[i + step] + z[i] * z[i + step];
        to[i] = AngleWeight(dot == 0 ? 1.0f : dot);
      }
    });
  }
  std::size_t k = ScanMesh::kDirections * n;
  for (const auto& [i, j] : mesh.Seam()) angle_[k++] = weigh(i, j);
}

void EdgeWeights::Sort(const ScanMesh& mesh, EdgeOrder order) {
  const std::size_t n = mesh.Size();
  const std::uint16_t* keys = order == EdgeOrder::kColour ? colour_.data() : angle_.data();
  first_.assign(std::max(kColourBins, kAngleBins) + 1, 0);
  std::uint32_t* count = first_.data() + 1;
  const std::uint8_t* links = mesh.Links();
  for (std::size_t i = 0; i < n; ++i) {
    // Most points have all of their links, or none.
    const unsigned bits = links[i];
    if (bits == 0) continue;
    for (std::size_t d = 0; d < ScanMesh::kDirections; ++d)
      if ((bits >> d & 1) != 0) ++count[keys[d * n + i]];
  }
  const std::size_t seam = ScanMesh::kDirections * n;
  for (std::size_t k = 0; k < mesh.Seam().size(); ++k) ++count[keys[seam + k]];
  std::uint32_t sum = 0;
  for (std::uint32_t& first : first_) first = sum += first;
  sorted_.resize(sum);
  std::uint32_t* next = first_.data();
  const auto put = [&](std::size_t code, std::size_t place) {
    sorted_[next[keys[place]]++] = {static_cast<std::uint32_t>(code), colour_[place],
                                    angle_[place]};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const unsigned bits = links[i];
    if (bits == 0) continue;
    for (std::size_t d = 0; d < ScanMesh::kDirections; ++d)
      if ((bits >> d & 1) != 0) put(4 * i + d, d * n + i);
  }
  for (std::size_t k = 0; k < mesh.Seam().size(); ++k) put(seam + k, seam + k);
}

void EdgeWeights::Compute(const ScanMesh& mesh, const Rgb* colours, const SurfaceNormals* normals,
                          EdgeOrder order) {
  const std::size_t all = ScanMesh::kDirections * mesh.Size() + mesh.Seam().size();
  if (colours) {
    colour_.resize(all);
    WeighColours(mesh, colours);
  } else {
    colour_.assign(all, 0);
  }
  if (normals) {
    angle_.resize(all);
    WeighAngles(mesh, *normals);
  } else {
    angle_.assign(all, 0);
  }
  Sort(mesh, order);
}

}  // namespace graticule
