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

SegmentOptions DefaultsOf(SegmentMethod method) {
  SegmentOptions options;
  options.method = method;
  options.mesh.grazing_rad = 0.14;
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

const std::vector<std::uint32_t>& Segmenter::Segment(const PointCloud& cloud) {
  const SegmentMethod method = options_.method;
  const bool by_colour = method == SegmentMethod::kJoint || method == SegmentMethod::kColour ||
                         method == SegmentMethod::kImage;
  const bool by_normals = method == SegmentMethod::kJoint || method == SegmentMethod::kNormals;
  if (by_colour && cloud.colours.size() != cloud.Size())
    throw Error("the cloud has no colours, which this method segments by", ErrorKind::kInput);
  if (method == SegmentMethod::kImage)
    mesh_.BuildGrid(cloud.width, cloud.height);
  else
    mesh_.Build(cloud, options_.mesh);
  if (method == SegmentMethod::kConvex) {
    normals_.Compute(mesh_, options_.normal_radius);
    convex_.Segment(mesh_, normals_, options_.convex);
    return convex_.Labels();
  }
  if (by_normals) normals_.Compute(mesh_, options_.normal_radius);
  weights_.Compute(mesh_, by_colour ? cloud.colours.data() : nullptr,
                   by_normals ? &normals_ : nullptr,
                   by_colour ? EdgeOrder::kColour : EdgeOrder::kAngle);
  graph_.Segment(mesh_, weights_.Sorted(), options_.graph);
  return graph_.Labels();
}

std::size_t Segmenter::SegmentCount() const {
  return options_.method == SegmentMethod::kConvex ? convex_.Count() : graph_.Count();
}

}  // namespace graticule
