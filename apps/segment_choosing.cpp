#include "segment_choosing.hpp"

#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule::apps {
namespace {

constexpr double kDegree = M_PI / 180;

bool UsesColour(SegmentMethod method) {
  return method != SegmentMethod::kConvex && method != SegmentMethod::kNormals;
}
bool UsesAngles(SegmentMethod method) {
  return method == SegmentMethod::kJoint || method == SegmentMethod::kNormals;
}
bool UsesNormals(SegmentMethod method) {
  return UsesAngles(method) || method == SegmentMethod::kConvex;
}
bool UsesMesh(SegmentMethod method) { return method != SegmentMethod::kImage; }
bool IsConvex(SegmentMethod method) { return method == SegmentMethod::kConvex; }
bool Always(SegmentMethod) { return true; }

using Choosing = SegmentChoosing;
using Options = SegmentOptions;
constexpr double kMost = 1e9, kLeast = 1e-9;
constexpr SegmentParameter kParameters[] = {
    {"k-rgb", "k-rgb", &Choosing::k_colour, kLeast, kMost, false, UsesColour,
     [](const Options& options) { return options.graph.k_colour; }},
    {"k-norm", "k-norm", &Choosing::k_normal, kLeast, kMost, false, UsesAngles,
     [](const Options& options) { return options.graph.k_normal; }},
    {"min-size", "min-size [points]", &Choosing::min_size, 0, kMost, true, Always,
     [](const Options& options) {
       return static_cast<double>(options.method == SegmentMethod::kConvex
                                      ? options.convex.min_size
                                      : options.graph.min_size);
     }},
    {"normal-radius", "normal-radius [points]", &Choosing::normal_radius, 1, 16, true, UsesNormals,
     [](const Options& options) { return static_cast<double>(options.normal_radius); }},
    {"concave", "concave [degrees]", &Choosing::concave_deg, 0, 180, false, IsConvex,
     [](const Options& options) { return options.convex.concave_angle_rad / kDegree; }},
    {"edge-cut", "edge-cut [m]", &Choosing::edge_cut_m, kLeast, kMost, false, UsesMesh,
     [](const Options& options) { return options.mesh.edge_cut_m; }},
    {"grazing", "grazing [degrees]", &Choosing::grazing_deg, 0, 89, false, UsesMesh,
     [](const Options& options) { return options.mesh.grazing_rad / kDegree; }},
};

}  // namespace

bool SegmentParameter::Allows(double value) const {
  return value >= least && value <= most && (!is_whole || value == std::floor(value));
}

std::vector<SegmentParameter> ParametersOf(SegmentMethod method) {
  std::vector<SegmentParameter> parameters;
  for (const SegmentParameter& parameter : kParameters)
    if (parameter.matters(method)) parameters.push_back(parameter);
  return parameters;
}

const SegmentParameter& ParameterOf(const std::string& name) {
  std::string all;
  for (const SegmentParameter& parameter : kParameters) {
    if (name == parameter.name) return parameter;
    all += std::string(all.empty() ? "" : ", ") + parameter.name;
  }
  throw Error("--sweep: no such parameter: '" + name + "'; expected one of " + all,
              ErrorKind::kUsage);
}

SegmentOptions OptionsOf(SegmentMethod method, const SegmentChoosing& choosing,
                         const PointCloud& cloud) {
  SegmentOptions options = DefaultsOf(method, cloud.is_spinning);
  options.mesh.is_closed |= choosing.is_closed;
  if (choosing.edge_cut_m >= 0) options.mesh.edge_cut_m = choosing.edge_cut_m;
  if (choosing.grazing_deg >= 0) options.mesh.grazing_rad = choosing.grazing_deg * kDegree;
  if (choosing.normal_radius >= 0) options.normal_radius = static_cast<int>(choosing.normal_radius);
  if (choosing.k_colour >= 0) options.graph.k_colour = choosing.k_colour;
  if (choosing.k_normal >= 0) options.graph.k_normal = choosing.k_normal;
  if (choosing.concave_deg >= 0) options.convex.concave_angle_rad = choosing.concave_deg * kDegree;
  if (choosing.min_size >= 0)
    options.graph.min_size = options.convex.min_size = static_cast<std::size_t>(choosing.min_size);
  return options;
}

}  // namespace graticule::apps
