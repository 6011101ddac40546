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

// Normals are of length 1, or 0 where there is none.
GRATICULE_WIDE inline float SquaredLength(float x, float y, float z) {
  return x * x + y * y + z * z;
}

// Abramowitz and Stegun 4.4.45, within 7e-5 rad.
GRATICULE_WIDE inline std::uint16_t AngleWeight(float dot) {
  const float x = std::min(std::fabs(dot), 1.0f);
  const float sharp =
      std::sqrt(1 - x) * (1.5707288f + x * (-0.2121144f + x * (0.0742610f - x * 0.0187293f)));
  const float angle = dot < 0 ? kPi - sharp : sharp;
  const float steps = angle * (EdgeWeights::kAngleSteps / kPi);
  return static_cast<std::uint16_t>(static_cast<int>(steps + 0.5f));
}

std::uint16_t AngleBetween(const SurfaceNormals& normals, std::size_t i, std::size_t j) {
  const float *x = normals.X(), *y = normals.Y(), *z = normals.Z();
  const float both = SquaredLength(x[i], y[i], z[i]) * SquaredLength(x[j], y[j], z[j]);
  return both > 0 ? AngleWeight(x[i] * x[j] + y[i] * y[j] + z[i] * z[j]) : std::uint16_t{0};
}

}  // namespace

void EdgeWeights::Begin(EdgeOrder order) {
  order_ = order;
  rows_ = 0;
  for (std::vector<std::uint8_t>* list : {&red_, &green_, &blue_}) list->clear();
  for (std::vector<std::uint16_t>* list : {&colour_, &angle_, &seam_colour_, &seam_angle_})
    list->clear();
  first_.assign(std::max(kColourBins, kAngleBins) + 1, 0);
}

void EdgeWeights::AddColours(const Rgb* row, std::size_t width) {
  const std::size_t before = red_.size();
  for (std::vector<std::uint8_t>* list : {&red_, &green_, &blue_}) list->resize(before + width);
  for (std::size_t c = 0; c < width; ++c) {
    red_[before + c] = row[c][0];
    green_[before + c] = row[c][1];
    blue_[before + c] = row[c][2];
  }
}

// Edges of the row `rows_` in the first so many directions; the others' weights are zero.
void EdgeWeights::WeighRow(const ScanMesh& mesh, const SurfaceNormals* normals, int directions) {
  const std::size_t width = mesh.Width(), row = rows_ * width;
  for (int d = 0; d < directions; ++d) {
    const std::ptrdiff_t step = mesh.Step(d);
    const std::size_t place = ScanMesh::kDirections * row + static_cast<std::size_t>(d) * width;
    // What is right of a row is not there.
    const bool is_right = d == ScanMesh::kRight || d == ScanMesh::kDownRight;
    const std::size_t count = is_right ? width - 1 : width;
    if (!red_.empty()) {
      std::uint16_t* to = &colour_[place];
      const std::uint8_t *r = &red_[row], *g = &green_[row], *b = &blue_[row];
      const std::uint8_t *far_r = r + step, *far_g = g + step, *far_b = b + step;
      RunWide([=]() GRATICULE_WIDE {
#pragma GCC ivdep
        for (std::size_t c = 0; c < count; ++c)
          to[c] = ColourWeight(far_r[c] - r[c], far_g[c] - g[c], far_b[c] - b[c]);
      });
    }
    if (normals != nullptr) {
      std::uint16_t* to = &angle_[place];
      const float *x = normals->X() + row, *y = normals->Y() + row, *z = normals->Z() + row;
      const float *far_x = x + step, *far_y = y + step, *far_z = z + step;
      RunWide([=]() GRATICULE_WIDE {
#pragma GCC ivdep
        for (std::size_t c = 0; c < count; ++c) {
          const float dot = x[c] * far_x[c] + y[c] * far_y[c] + z[c] * far_z[c];
          const float both =
              SquaredLength(x[c], y[c], z[c]) * SquaredLength(far_x[c], far_y[c], far_z[c]);
          to[c] = AngleWeight(both > 0 ? dot : 1.0f);
        }
      });
    }
  }
}

void EdgeWeights::WeighSeam(const ScanMesh& mesh, const SurfaceNormals* normals) {
  for (const auto& [i, j] : mesh.Seam()) {
    seam_colour_.push_back(
        red_.empty() ? std::uint16_t{0}
                     : ColourWeight(red_[j] - red_[i], green_[j] - green_[i], blue_[j] - blue_[i]));
    seam_angle_.push_back(normals == nullptr ? std::uint16_t{0} : AngleBetween(*normals, i, j));
  }
}

// How many edges of the row `rows_` have each weight.
void EdgeWeights::Count(const ScanMesh& mesh) {
  const std::size_t width = mesh.Width(), row = rows_ * width;
  const std::vector<std::uint16_t>& weights = order_ == EdgeOrder::kColour ? colour_ : angle_;
  const std::uint16_t* keys = &weights[ScanMesh::kDirections * row];
  const std::uint8_t* links = mesh.Links() + row;
  std::uint32_t* count = first_.data() + 1;
  for (std::size_t c = 0; c < width; ++c) {
    // Most points have all of their links, or none.
    const unsigned bits = links[c];
    if (bits == 0) continue;
    for (std::size_t d = 0; d < ScanMesh::kDirections; ++d)
      if ((bits >> d & 1) != 0) ++count[keys[d * width + c]];
  }
}

void EdgeWeights::WeighUntil(const ScanMesh& mesh, const SurfaceNormals* normals, std::size_t end) {
  if (rows_ >= end) return;
  colour_.resize(ScanMesh::kDirections * end * mesh.Width());
  angle_.resize(colour_.size());
  for (; rows_ < end; ++rows_) {
    const bool is_last = rows_ + 1 == mesh.Height();
    WeighRow(mesh, normals, is_last ? 1 : int{ScanMesh::kDirections});
    Count(mesh);
  }
}

void EdgeWeights::Extend(const ScanMesh& mesh, const SurfaceNormals* normals) {
  const std::size_t known = normals == nullptr ? mesh.Height() : normals->Rows();
  if (known > 0) WeighUntil(mesh, normals, known - 1);
}

void EdgeWeights::Finish(const ScanMesh& mesh, const SurfaceNormals* normals) {
  WeighUntil(mesh, normals, mesh.Height());
  WeighSeam(mesh, normals);
  Sort(mesh);
}

void EdgeWeights::Sort(const ScanMesh& mesh) {
  const bool by_colour = order_ == EdgeOrder::kColour;
  for (const std::uint16_t key : by_colour ? seam_colour_ : seam_angle_) ++first_[key + 1u];
  std::uint32_t sum = 0;
  for (std::uint32_t& first : first_) first = sum += first;
  sorted_.resize(sum);
  std::uint32_t* next = first_.data();
  const auto put = [&](std::size_t code, std::uint16_t colour, std::uint16_t angle) {
    sorted_[next[by_colour ? colour : angle]++] = {static_cast<std::uint32_t>(code), colour, angle};
  };
  const std::uint8_t* links = mesh.Links();
  const std::size_t width = mesh.Width();
  for (std::size_t row = 0; row < mesh.Height(); ++row) {
    const std::uint16_t* colour = &colour_[ScanMesh::kDirections * row * width];
    const std::uint16_t* angle = &angle_[ScanMesh::kDirections * row * width];
    for (std::size_t c = 0; c < width; ++c) {
      const std::size_t i = row * width + c;
      const unsigned bits = links[i];
      if (bits == 0) continue;
      for (std::size_t d = 0; d < ScanMesh::kDirections; ++d)
        if ((bits >> d & 1) != 0) put(4 * i + d, colour[d * width + c], angle[d * width + c]);
    }
  }
  for (std::size_t k = 0; k < mesh.Seam().size(); ++k)
    put(ScanMesh::kDirections * mesh.Size() + k, seam_colour_[k], seam_angle_[k]);
}

void EdgeWeights::Compute(const ScanMesh& mesh, const Rgb* colours, const SurfaceNormals* normals,
                          EdgeOrder order) {
  Begin(order);
  if (colours != nullptr) AddColours(colours, mesh.Size());
  Finish(mesh, normals);
}

}  // namespace graticule
