#include "graticule/problems/segmentation/scan_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr float kFarthest2 = 1e30f;  // m^2

}  // namespace

// Whether an edge stays.  Two ends that are nowhere are at one place: the farthest of all.
inline bool ScanMesh::IsLink(float px, float py, float pz, float qx, float qy, float qz,
                             const Cuts& cuts) {
  const float dx = qx - px, dy = qy - py, dz = qz - pz;
  const float mx = qx + px, my = qy + py, mz = qz + pz;  // twice the middle
  const float length2 = dx * dx + dy * dy + dz * dz;
  const float along = dx * mx + dy * my + dz * mz;
  const float middle2 = mx * mx + my * my + mz * mz;
  return (length2 <= cuts.longest2) & (middle2 < kFarthest2) &
         (along * along <= cuts.cos2 * length2 * middle2);
}

// Links of `count` points from the first in one direction.
void ScanMesh::Link(std::size_t first, std::size_t count, Direction direction) {
  const Cuts cuts = cuts_;
  const std::ptrdiff_t step = Step(direction);
  const float *x = &x_[first], *y = &y_[first], *z = &z_[first];
  std::uint8_t* links = &links_[first];
  for (std::size_t c = 0; c < count; ++c, ++x, ++y, ++z)
    links[c] |=
        static_cast<std::uint8_t>(IsLink(*x, *y, *z, x[step], y[step], z[step], cuts) << direction);
}

void ScanMesh::LinkSeam(std::size_t p, std::size_t q) {
  if (IsLink(x_[p], y_[p], z_[p], x_[q], y_[q], z_[q], cuts_))
    seam_.emplace_back(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q));
}

void ScanMesh::Begin(std::size_t width, const MeshOptions& options) {
  width_ = width;
  height_ = 0;
  const std::ptrdiff_t w = static_cast<std::ptrdiff_t>(width);
  steps_[kRight] = 1;
  steps_[kDownLeft] = w - 1;
  steps_[kDown] = w;
  steps_[kDownRight] = w + 1;
  const float longest = static_cast<float>(options.edge_cut_m);
  const double cosine = options.grazing_rad > 0 ? std::cos(options.grazing_rad) : 2;
  // A seam of two columns joins what is joined already.
  cuts_ = {longest * longest, static_cast<float>(cosine * cosine), options.is_closed && width > 2};
  for (std::vector<float>* list : {&x_, &y_, &z_}) list->clear();
  links_.clear();
  seam_.clear();
}

void ScanMesh::AddEmptyRow() {
  ++height_;
  for (std::vector<float>* list : {&x_, &y_, &z_}) list->resize(Size(), kNowhere);
  links_.resize(Size(), 0);
}

void ScanMesh::AddGridRow() {
  AddEmptyRow();
  const std::size_t row = Size() - width_;
  for (std::size_t c = 0; c < width_; ++c) {
    const unsigned right = c + 1 < width_, left = c > 0;
    links_[row + c] = static_cast<std::uint8_t>(right << kRight);
    if (row > 0)
      links_[row - width_ + c] |=
          static_cast<std::uint8_t>(left << kDownLeft | 1u << kDown | right << kDownRight);
  }
}

void ScanMesh::AddRow(const Eigen::Vector3f* points) {
  AddEmptyRow();
  const std::size_t row = Size() - width_;
  for (std::size_t c = 0; c < width_; ++c) {
    const Eigen::Vector3f& p = points[c];
    const bool is_seen = std::isfinite(p.x()) & std::isfinite(p.y()) & std::isfinite(p.z());
    x_[row + c] = is_seen ? p.x() : kNowhere;
    y_[row + c] = is_seen ? p.y() : kNowhere;
    z_[row + c] = is_seen ? p.z() : kNowhere;
  }
  const std::size_t last = row + width_ - 1;
  if (row > 0) {
    const std::size_t before = row - width_;
    Link(before + 1, width_ - 1, kDownLeft);
    Link(before, width_, kDown);
    Link(before, width_ - 1, kDownRight);
    if (cuts_.is_round) {
      LinkSeam(before, last);
      LinkSeam(row - 1, row);
    }
  }
  Link(row, width_ - 1, kRight);
  if (cuts_.is_round) LinkSeam(row, last);
}

void ExpectOrganised(const PointCloud& cloud) {
  if (cloud.Size() == 0) throw Error("the cloud has no points", ErrorKind::kInput);
  if (!cloud.IsOrganised() || cloud.width * cloud.height != cloud.Size())
    throw Error("the cloud is not organised: expected rows of points, neighbours in direction (" +
                    std::to_string(cloud.width) + " x " + std::to_string(cloud.height) + ", " +
                    std::to_string(cloud.Size()) + " points)",
                ErrorKind::kInput);
}

void ScanMesh::Build(const PointCloud& cloud, const MeshOptions& options) {
  ExpectOrganised(cloud);
  Begin(cloud.width, options);
  for (std::size_t row = 0; row < cloud.height; ++row) AddRow(&cloud.in_sensor[row * cloud.width]);
}

std::size_t ScanMesh::EdgeCount() const {
  std::size_t count = seam_.size();
  for (const std::uint8_t links : links_)
    count += static_cast<std::size_t>(__builtin_popcount(links));
  return count;
}

}  // namespace graticule
