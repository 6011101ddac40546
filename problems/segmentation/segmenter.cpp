#include "graticule/problems/segmentation/segmenter.hpp"

#include <array>
#include <string>
#include <utility>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::array<std::pair<std::string_view, SegmentMethod>, 5> kNames = {{
    {"convex", SegmentMethod::kConvex},
    {"joint", SegmentMethod::kJoint},
    {"colour", SegmentMethod::kColour},
    {"normals", SegmentMethod::kNormals},
    {"image", SegmentMethod::kImage},
}};

// Of a weight that a method has not: never in the way.
constexpr double kAny = 1e9;

constexpr double kPi = 3.14159265358979323846;

}  // namespace

SegmentMethod SegmentMethodOf(std::string_view name) {
  std::string all;
  for (const auto& [known, method] : kNames) {
    if (known == name) return method;
    all += (all.empty() ? "" : ", ") + std::string(known);
  }
  throw Error("no such method: '" + std::string(name) + "'; expected one of " + all,
              ErrorKind::kUsage);
}

SegmentOptions DefaultsOf(SegmentMethod method, bool is_spinning) {
  SegmentOptions options;
  options.method = method;
  options.mesh.grazing_rad = 0.14;
  if (is_spinning) options.mesh = {2, kPi / 90, true};
  switch (method) {
    case SegmentMethod::kConvex:
      break;
    case SegmentMethod::kJoint:
      options.graph = {50000, 20, 200};
      options.normal_radius = 1;
      break;
    case SegmentMethod::kNormals:
      options.graph = {kAny, 20, 200};
      options.normal_radius = 3;
      break;
    case SegmentMethod::kColour:
      options.graph = {3000, kAny, 200};
      break;
    case SegmentMethod::kImage:
      options.graph = {3000, kAny, 500};
      break;
  }
  return options;
}

bool Segmenter::ByColour() const {
  return options_.method == SegmentMethod::kJoint || options_.method == SegmentMethod::kColour ||
         options_.method == SegmentMethod::kImage;
}

void Segmenter::Begin(std::size_t width) {
  if (width == 0) throw Error("expected scans of at least one point", ErrorKind::kUsage);
  width_ = width;
  mesh_.Begin(width, options_.mesh);
  normals_.Begin(width, options_.normal_radius);
  weights_.Begin(ByColour() ? EdgeOrder::kColour : EdgeOrder::kAngle);
}

void Segmenter::Add(const Eigen::Vector3f* points, const Rgb* colours) {
  if (options_.method == SegmentMethod::kImage)
    mesh_.AddGridRow();
  else
    mesh_.AddRow(points);
  if (ByNormals()) normals_.Extend(mesh_);
  if (options_.method == SegmentMethod::kConvex) return;
  if (ByColour()) weights_.AddColours(colours, width_);
  weights_.Extend(mesh_, ByNormals() ? &normals_ : nullptr);
}

void Segmenter::AddScan(Span<const Eigen::Vector3f> points, Span<const Rgb> colours) {
  if (width_ == 0) throw Error("expected Begin before a scan", ErrorKind::kUsage);
  if (points.size() != width_ || (ByColour() && colours.size() != width_))
    throw Error("expected scans of " + std::to_string(width_) + " points" +
                    (ByColour() ? ", each with a colour" : ""),
                ErrorKind::kUsage);
  Add(points.data(), colours.data());
}

const std::vector<std::uint32_t>& Segmenter::Finish() {
  if (width_ == 0 || mesh_.Height() < 2)
    throw Error("a cloud of fewer than two scans", ErrorKind::kInput);
  width_ = 0;
  if (ByNormals()) normals_.Finish(mesh_);
  if (options_.method == SegmentMethod::kConvex) {
    convex_.Segment(mesh_, normals_, options_.convex);
    return convex_.Labels();
  }
  weights_.Finish(mesh_, ByNormals() ? &normals_ : nullptr);
  graph_.Segment(mesh_, weights_.Sorted(), options_.graph);
  return graph_.Labels();
}

const std::vector<std::uint32_t>& Segmenter::Segment(const PointCloud& cloud) {
  if (ByColour() && cloud.colours.size() != cloud.Size())
    throw Error("the cloud has no colours, which this method segments by", ErrorKind::kInput);
  ExpectOrganised(cloud);
  Begin(cloud.width);
  for (std::size_t i = 0; i < cloud.Size(); i += cloud.width)
    Add(&cloud.in_sensor[i], ByColour() ? &cloud.colours[i] : nullptr);
  return Finish();
}

std::size_t Segmenter::SegmentCount() const {
  return options_.method == SegmentMethod::kConvex ? convex_.Count() : graph_.Count();
}

}  // namespace graticule
