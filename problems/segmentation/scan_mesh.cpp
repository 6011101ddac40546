#include "graticule/problems/segmentation/scan_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr float kFarthest2 = 1e30f;  // m^2

struct Cuts {
  float longest2;  // m^2
  float cos2;      // of the grazing angle
};

// Whether an edge stays.  Two ends that are nowhere are at one place: the farthest of all.
inline bool IsLink(float px, float py, float pz, float qx, float qy, float qz, Cuts cuts) {
  const float dx = qx - px, dy = qy - py, dz = qz - pz;
  const float mx = qx + px, my = qy + py, mz = qz + pz;  // twice the middle
  const float length2 = dx * dx + dy * dy + dz * dz;
  const float along = dx * mx + dy * my + dz * mz;
  const float middle2 = mx * mx + my * my + mz * mz;
  return (length2 <= cuts.longest2) & (middle2 < kFarthest2) &
         (along * along <= cuts.cos2 * length2 * middle2);
}

// Links of `count` points from place `i` in one direction.
void LinkRow(const float* x, const float* y, const float* z, std::ptrdiff_t step, std::size_t count,
             Cuts cuts, int direction, std::uint8_t* links) {
  for (std::size_t c = 0; c < count; ++c)
    links[c] |= static_cast<std::uint8_t>(
        IsLink(x[c], y[c], z[c], x[c + step], y[c + step], z[c + step], cuts) << direction);
}

}  // namespace

void ScanMesh::SetSize(std::size_t width, std::size_t height) {
  width_ = width;
  height_ = height;
  const std::ptrdiff_t w = static_cast<std::ptrdiff_t>(width);
  steps_[kRight] = 1;
  steps_[kDownLeft] = w - 1;
  steps_[kDown] = w;
  steps_[kDownRight] = w + 1;
  x_.resize(Size());
  y_.resize(Size());
  z_.resize(Size());
  links_.assign(Size(), 0);
  seam_.clear();
}

void ScanMesh::BuildGrid(std::size_t width, std::size_t height) {
  if (width == 0 || height < 2)
    throw Error("the cloud is not organised: expected rows of points", ErrorKind::kInput);
  SetSize(width, height);
  std::fill(x_.begin(), x_.end(), kNowhere);
  std::fill(y_.begin(), y_.end(), kNowhere);
  std::fill(z_.begin(), z_.end(), kNowhere);
  for (std::size_t row = 0; row < height; ++row)
    for (std::size_t column = 0; column < width; ++column) {
      const unsigned right = column + 1 < width, left = column > 0, down = row + 1 < height;
      links_[row * width + column] =
          static_cast<std::uint8_t>(right << kRight | (left & down) << kDownLeft | down << kDown |
                                    (right & down) << kDownRight);
    }
}

void ScanMesh::Build(const PointCloud& cloud, const MeshOptions& options) {
  if (cloud.Size() == 0) throw Error("the cloud has no points", ErrorKind::kInput);
  if (!cloud.IsOrganised() || cloud.width * cloud.height != cloud.Size())
    throw Error("the cloud is not organised: expected rows of points, neighbours in direction (" +
                    std::to_string(cloud.width) + " x " + std::to_string(cloud.height) + ", " +
                    std::to_string(cloud.Size()) + " points)",
                ErrorKind::kInput);
  SetSize(cloud.width, cloud.height);
  const std::size_t n = Size();
  const std::ptrdiff_t w = Step(kDown);
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3f& p = cloud.in_sensor[i];
    const bool is_seen = std::isfinite(p.x()) & std::isfinite(p.y()) & std::isfinite(p.z());
    x_[i] = is_seen ? p.x() : kNowhere;
    y_[i] = is_seen ? p.y() : kNowhere;
    z_[i] = is_seen ? p.z() : kNowhere;
  }
  const float longest = static_cast<float>(options.edge_cut_m);
  const double cosine = options.grazing_rad > 0 ? std::cos(options.grazing_rad) : 2;
  const Cuts cuts = {longest * longest, static_cast<float>(cosine * cosine)};
  for (std::size_t row = 0; row < height_; ++row) {
    const std::size_t i = row * width_;
    const float *x = &x_[i], *y = &y_[i], *z = &z_[i];
    LinkRow(x, y, z, 1, width_ - 1, cuts, kRight, &links_[i]);
    const auto join = [&](std::size_t p, std::size_t q) {
      if (IsLink(x_[p], y_[p], z_[p], x_[q], y_[q], z_[q], cuts))
        seam_.emplace_back(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q));
    };
    const bool is_wide = width_ > 2;  // else the seam joins what is joined already
    const std::size_t last = i + width_ - 1;
    if (options.is_closed && is_wide) join(i, last);
    if (row + 1 == height_) continue;
    LinkRow(x + 1, y + 1, z + 1, w - 1, width_ - 1, cuts, kDownLeft, &links_[i + 1]);
    LinkRow(x, y, z, w, width_, cuts, kDown, &links_[i]);
    LinkRow(x, y, z, w + 1, width_ - 1, cuts, kDownRight, &links_[i]);
    if (options.is_closed && is_wide) {
      join(i, last + width_);
      join(last, i + width_);
    }
  }
}

std::size_t ScanMesh::EdgeCount() const {
  std::size_t count = seam_.size();
  for (const std::uint8_t links : links_)
    count += static_cast<std::size_t>(__builtin_popcount(links));
  return count;
}

}  // namespace graticule
