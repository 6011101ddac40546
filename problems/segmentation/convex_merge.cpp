#include "graticule/problems/segmentation/convex_merge.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace graticule {
namespace {

constexpr int kRounds = 6;  // of sharing out, and of joining small segments
constexpr double kDegree = 3.14159265358979323846 / 180;

// Links of a point to earlier ones are kept with those.
template <class Visit>
void VisitLinks(const ScanMesh& mesh, std::size_t i, Visit visit) {
  const std::uint8_t* links = mesh.Links();
  const std::size_t n = mesh.Size();
  for (int d = 0; d < ScanMesh::kDirections; ++d) {
    const std::size_t step = static_cast<std::size_t>(mesh.Step(d));
    if (i >= step && (links[i - step] >> d & 1) != 0) visit(i - step);
    if (i + step < n && (links[i] >> d & 1) != 0) visit(i + step);
  }
}

}  // namespace

// The connected pieces of one block, found among its own points.
void ConvexMerge::MakeBlock(const ScanMesh& mesh, const SurfaceNormals& normals, std::size_t row,
                            std::size_t column, const ConvexMergeOptions& options,
                            float least_cosine) {
  const std::size_t block = options.block, width = mesh.Width();
  const std::size_t rows = std::min(block, mesh.Height() - row);
  const std::size_t columns = std::min(block, width - column);
  std::uint16_t parents[kLargestBlock * kLargestBlock];
  const auto find = [&](std::size_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  };
  const float *x = normals.X(), *y = normals.Y(), *z = normals.Z();
  std::iota(parents, parents + rows * block, std::uint16_t{0});
  bool is_empty = true;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t i = (row + r) * width + column + c, own = r * block + c;
      const unsigned links = mesh.Links()[i];
      is_empty &= links == 0;
      const auto join = [&](int d, std::size_t other) {
        if ((links >> d & 1) == 0) return;
        const std::size_t j = i + static_cast<std::size_t>(mesh.Step(d));
        // A point without a normal has the product zero, and joins nothing.
        if (x[i] * x[j] + y[i] * y[j] + z[i] * z[j] < least_cosine) return;
        const std::size_t a = find(own), b = find(other);
        parents[std::max(a, b)] = static_cast<std::uint16_t>(std::min(a, b));
      };
      if (c + 1 < columns) join(ScanMesh::kRight, own + 1);
      if (r + 1 == rows) continue;
      if (c > 0) join(ScanMesh::kDownLeft, own + block - 1);
      join(ScanMesh::kDown, own + block);
      if (c + 1 < columns) join(ScanMesh::kDownRight, own + block + 1);
    }
  if (is_empty) return;
  std::uint16_t counts[kLargestBlock * kLargestBlock] = {};
  std::uint32_t ids[kLargestBlock * kLargestBlock];
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) ++counts[find(r * block + c)];
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t own = r * block + c, root = find(own);
      const std::size_t i = (row + r) * width + column + c;
      if (counts[root] < options.patch_points) {
        if (mesh.X()[i] != ScanMesh::kNowhere) loose_.push_back(static_cast<std::uint32_t>(i));
        continue;
      }
      if (root == own) {  // its first point
        ids[root] = static_cast<std::uint32_t>(patches_.size());
        patches_.emplace_back();
      }
      Patch& patch = patches_[patch_of_[i] = ids[root]];
      patch.centre += Eigen::Vector3f(mesh.X()[i], mesh.Y()[i], mesh.Z()[i]);
      patch.normal += Eigen::Vector3f(x[i], y[i], z[i]);
      ++patch.points;
    }
}

void ConvexMerge::MakePatches(const ScanMesh& mesh, const SurfaceNormals& normals,
                              const ConvexMergeOptions& options) {
  patch_of_.assign(mesh.Size(), kNone);
  patches_.clear();
  loose_.clear();
  const float least_cosine = static_cast<float>(std::cos(options.patch_angle_rad));
  for (std::size_t row = 0; row < mesh.Height(); row += options.block)
    for (std::size_t column = 0; column < mesh.Width(); column += options.block)
      MakeBlock(mesh, normals, row, column, options, least_cosine);
  for (Patch& patch : patches_) {
    patch.centre /= static_cast<float>(patch.points);
    patch.normal.normalize();
  }
}

// Loose points go, ring by ring, to a patch that they are linked to: whose plane is the nearest.
void ConvexMerge::ShareOut(const ScanMesh& mesh) {
  for (int round = 0; round < kRounds && !loose_.empty(); ++round) {
    std::size_t left = 0;
    for (const std::uint32_t i : loose_) {
      const Eigen::Vector3f point(mesh.X()[i], mesh.Y()[i], mesh.Z()[i]);
      std::uint32_t patch = kNone;
      float nearest = std::numeric_limits<float>::infinity();
      VisitLinks(mesh, i, [&](std::size_t j) {
        const std::uint32_t other = patch_of_[j];
        if (other == kNone || other == patch) return;
        const float off = std::fabs(patches_[other].normal.dot(point - patches_[other].centre));
        if (off >= nearest) return;
        nearest = off;
        patch = other;
      });
      if (patch == kNone)
        loose_[left++] = i;
      else
        patch_of_[i] = patch;
    }
    if (left == loose_.size()) break;
    loose_.resize(left);
  }
}

std::size_t ConvexMerge::SlotOf(std::uint32_t a, std::uint32_t b) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = (std::size_t{a} * 0x9E3779B1u + std::size_t{b} * 0x85EBCA77u) >> 3 & mask;
  const auto is_other = [&](std::uint32_t place) {
    return place != kNone && (borders_[place].a != a || borders_[place].b != b);
  };
  while (is_other(table_[slot])) slot = (slot + 1) & mask;
  return slot;
}

void ConvexMerge::AddBorder(std::uint32_t a, std::uint32_t b) {
  if (a > b) std::swap(a, b);
  std::uint32_t& place = table_[SlotOf(a, b)];
  if (place != kNone) {
    ++borders_[place].links;
    return;
  }
  place = static_cast<std::uint32_t>(borders_.size());
  borders_.push_back({a, b, 1});
  if (2 * borders_.size() < table_.size()) return;
  // Half full: once more, twice as wide.
  table_.assign(2 * table_.size(), kNone);
  for (std::size_t k = 0; k < borders_.size(); ++k)
    table_[SlotOf(borders_[k].a, borders_[k].b)] = static_cast<std::uint32_t>(k);
}

void ConvexMerge::FindBorders(const ScanMesh& mesh) {
  borders_.clear();
  table_.assign(std::max<std::size_t>(table_.size(), 1024), kNone);
  const std::uint8_t* links = mesh.Links();
  const std::size_t n = mesh.Size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t own = patch_of_[i];
    if (links[i] == 0 || own == kNone) continue;
    for (int d = 0; d < ScanMesh::kDirections; ++d) {
      if ((links[i] >> d & 1) == 0) continue;
      const std::uint32_t other = patch_of_[i + static_cast<std::size_t>(mesh.Step(d))];
      if (other != own && other != kNone) AddBorder(own, other);
    }
  }
  for (const auto& [i, j] : mesh.Seam())
    if (patch_of_[i] != kNone && patch_of_[j] != kNone && patch_of_[i] != patch_of_[j])
      AddBorder(patch_of_[i], patch_of_[j]);
}

bool ConvexMerge::IsJoined(const Border& border, const ConvexMergeOptions& options) const {
  if (border.links < options.min_links) return false;
  const Patch &a = patches_[border.a], &b = patches_[border.b];
  const Eigen::Vector3f between = (a.centre - b.centre).normalized();
  const float cosine = std::clamp(a.normal.dot(b.normal), -1.0f, 1.0f);
  const bool is_convex = (a.normal - b.normal).dot(between) >= 0;
  if (!is_convex) return cosine > std::cos(static_cast<float>(options.concave_angle_rad));
  // Two surfaces that meet along an edge lie to the sides of it; where the way from one to the
  // other runs along the edge, they touch at a point only.  Sharper edges are judged harder.
  const Eigen::Vector3f edge = a.normal.cross(b.normal);
  const float sine = edge.norm();
  if (sine < 1e-3f) return true;
  const double turn = std::acos(static_cast<double>(cosine)) / kDegree;
  const double least = 60 / (1 + std::exp(-0.25 * (turn - 25)));
  return std::fabs(between.dot(edge)) <= sine * static_cast<float>(std::cos(least * kDegree));
}

// Each small segment goes to its largest neighbour; those that were joined may go on.
void ConvexMerge::JoinSmall(const ConvexMergeOptions& options) {
  sizes_.assign(patches_.size(), 0);
  for (const std::uint32_t patch : patch_of_)
    if (patch != kNone) ++sizes_[sets_.Root(patch)];
  for (int round = 0; round < kRounds; ++round) {
    best_.assign(patches_.size(), kNone);
    bool is_any = false;
    const auto consider = [&](std::uint32_t small, std::uint32_t large) {
      if (sizes_[small] >= options.min_size) return;
      is_any = true;
      std::uint32_t& best = best_[small];
      if (best == kNone || sizes_[large] > sizes_[best]) best = large;
    };
    for (const Border& border : borders_) {
      const std::uint32_t a = sets_.Root(border.a), b = sets_.Root(border.b);
      if (a == b) continue;
      consider(a, b);
      consider(b, a);
    }
    if (!is_any) break;
    for (std::uint32_t small = 0; small < patches_.size(); ++small) {
      if (best_[small] == kNone || sets_.Root(small) != small) continue;
      const std::uint32_t to = sets_.Root(best_[small]);
      if (to == small) continue;
      sets_.Hang(small, to);
      sizes_[to] += sizes_[small];
    }
  }
}

void ConvexMerge::Relabel() {
  labels_.resize(patch_of_.size());
  names_.assign(patches_.size(), 0);
  count_ = 0;
  for (std::size_t i = 0; i < patch_of_.size(); ++i) {
    if (patch_of_[i] == kNone) {
      labels_[i] = 0;
      continue;
    }
    std::uint32_t& name = names_[sets_.Root(patch_of_[i])];
    if (name == 0) name = static_cast<std::uint32_t>(++count_);
    labels_[i] = name;
  }
}

void ConvexMerge::Segment(const ScanMesh& mesh, const SurfaceNormals& normals,
                          const ConvexMergeOptions& given) {
  ConvexMergeOptions options = given;
  options.block = std::clamp<std::size_t>(options.block, 2, kLargestBlock);
  MakePatches(mesh, normals, options);
  ShareOut(mesh);
  FindBorders(mesh);
  sets_.Reset(patches_.size());
  for (const Border& border : borders_) {
    if (!IsJoined(border, options)) continue;
    const std::uint32_t a = sets_.Root(border.a), b = sets_.Root(border.b);
    sets_.Hang(std::max(a, b), std::min(a, b));
  }
  JoinSmall(options);
  Relabel();
}

}  // namespace graticule
