#include "graticule/problems/pose_graph/landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "graticule/problems/pose_graph/transform.hpp"

namespace graticule {
namespace {

constexpr double kAssumedRangeM = 10;
// Two lines of sight that cross at less than this leave the distance to the noise.
const double kSmallestCrossing = std::sin(5 * M_PI / 180);

enum class Sight { kNone, kPlanar, kSpatial, kSpatialOffset, kBearing, kRange, kBearingRange };

Sight SightOf(std::string_view type) {
  if (type == "landmark_se2/1") return Sight::kPlanar;
  if (type == "landmark_se3/1") return Sight::kSpatial;
  if (type == "landmark_offset_se3/1") return Sight::kSpatialOffset;
  if (type == "bearing_se2/1") return Sight::kBearing;
  if (type == "range_se2/1") return Sight::kRange;
  if (type == "bearing_range_se2/1") return Sight::kBearingRange;
  return Sight::kNone;
}

void Polar(double range_m, double bearing_rad, double* in_body) {
  in_body[0] = range_m * std::cos(bearing_rad);
  in_body[1] = range_m * std::sin(bearing_rad);
}

// The landmark in the world, from a sighting that says all of it.
void PlaceAt(Sight sight, const double* pose, const double* measured, double* landmark) {
  double in_body[3] = {};
  switch (sight) {
    case Sight::kSpatial:
      return TransformPoint(false, pose, measured, landmark);
    case Sight::kSpatialOffset: {
      double body_from_sensor[7];
      CopyPose(false, measured + 3, body_from_sensor);
      TransformPoint(false, body_from_sensor, measured, in_body);
      return TransformPoint(false, pose, in_body, landmark);
    }
    case Sight::kBearingRange:
      Polar(measured[1], measured[0], in_body);
      return TransformPoint(true, pose, in_body, landmark);
    default:
      return TransformPoint(true, pose, measured, landmark);
  }
}

struct Ray {
  double x_m, y_m, heading_rad;
};

// Where two rays cross, ahead of both.
bool Cross(const Ray& a, const Ray& b, double* point) {
  const double c_a = std::cos(a.heading_rad), s_a = std::sin(a.heading_rad);
  const double c_b = std::cos(b.heading_rad), s_b = std::sin(b.heading_rad);
  const double crossing = c_a * s_b - s_a * c_b;
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  const double along_a = (dx * s_b - dy * c_b) / crossing;
  const double along_b = (dx * s_a - dy * c_a) / crossing;
  if (!(along_a > 0 && along_b > 0)) return false;
  point[0] = a.x_m + along_a * c_a;
  point[1] = a.y_m + along_a * s_a;
  return true;
}

// What is known of a landmark that no sighting says all of.
struct Partial {
  std::vector<Ray> rays;
  double range_m = -1;
  Ray seen_from{};
};

// True if the place was found, false if it was assumed.
bool PlaceFromPartial(const Partial& partial, double* point) {
  double ahead[2];
  if (partial.rays.empty()) {
    const double pose[3] = {partial.seen_from.x_m, partial.seen_from.y_m,
                            partial.seen_from.heading_rad};
    Polar(partial.range_m, 0, ahead);
    TransformPoint(true, pose, ahead, point);
    return false;
  }
  const Ray& first = partial.rays.front();
  const Ray* best = nullptr;
  double best_crossing = kSmallestCrossing;
  double candidate[2];
  for (const Ray& ray : partial.rays) {
    const double crossing = std::abs(std::sin(ray.heading_rad - first.heading_rad));
    if (crossing > best_crossing && Cross(first, ray, candidate)) {
      best_crossing = crossing;
      best = &ray;
    }
  }
  if (best) return Cross(first, *best, point);
  const double pose[3] = {first.x_m, first.y_m, first.heading_rad};
  Polar(partial.range_m >= 0 ? partial.range_m : kAssumedRangeM, 0, ahead);
  TransformPoint(true, pose, ahead, point);
  return false;
}

}  // namespace

PlacedLandmarks PlaceLandmarks(const Graph& graph, Values* values) {
  std::vector<Sight> sights;
  for (const FactorType& type : graph.UsedFactorTypes()) sights.push_back(SightOf(type.name));

  PlacedLandmarks count;
  std::vector<std::uint8_t> placed(graph.VariableCount());
  std::map<VariableId, Partial> partial;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const Sight sight = sights[graph.FactorTypeIndex(id)];
    if (sight == Sight::kNone) continue;
    const FactorView factor = graph.FactorAt(id);
    const VariableId landmark = factor.variables[1];
    if (placed[landmark] || graph.IsFixed(landmark)) continue;
    const double* pose = (*values)[factor.variables[0]].data();
    const double* measured = factor.measurement.data();
    if (sight == Sight::kBearing) {
      partial[landmark].rays.push_back({pose[0], pose[1], pose[2] + measured[0]});
    } else if (sight == Sight::kRange) {
      Partial& known = partial[landmark];
      if (known.range_m < 0) {
        known.range_m = measured[0];
        known.seen_from = {pose[0], pose[1], pose[2]};
      }
    } else {
      PlaceAt(sight, pose, measured, values->Mutable(landmark));
      placed[landmark] = 1;
      ++count.placed;
    }
  }
  for (const auto& [landmark, known] : partial) {
    if (placed[landmark]) continue;
    ++count.placed;
    if (!PlaceFromPartial(known, values->Mutable(landmark))) ++count.assumed;
  }
  return count;
}

}  // namespace graticule
