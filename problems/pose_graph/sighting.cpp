#include "graticule/problems/pose_graph/sighting.hpp"

#include <cmath>

#include "graticule/problems/pose_graph/transform.hpp"

namespace graticule {
namespace {

constexpr double kAssumedRangeM = 10;
// Two lines of sight that cross at less than this leave the distance to the noise.
const double kSmallestCrossing = std::sin(5 * M_PI / 180);

void Polar(double range_m, double bearing_rad, double* in_body) {
  in_body[0] = range_m * std::cos(bearing_rad);
  in_body[1] = range_m * std::sin(bearing_rad);
}

}  // namespace

Sight SightOf(std::string_view type) {
  if (type == "landmark_se2/1") return Sight::kPlanar;
  if (type == "landmark_se3/1") return Sight::kSpatial;
  if (type == "landmark_offset_se3/1") return Sight::kSpatialOffset;
  if (type == "bearing_se2/1") return Sight::kBearing;
  if (type == "range_se2/1") return Sight::kRange;
  if (type == "bearing_range_se2/1") return Sight::kBearingRange;
  return Sight::kNone;
}

void PlaceFromSight(Sight sight, const double* pose, const double* measured, double* landmark) {
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

void PartialSightings::Add(Sight sight, const double* pose, const double* measured) {
  if (sight == Sight::kBearing) {
    rays_.push_back({pose[0], pose[1], pose[2] + measured[0]});
  } else if (range_m_ < 0) {
    range_m_ = measured[0];
    range_from_ = {pose[0], pose[1], pose[2]};
  }
}

// Where two rays cross, ahead of both.
bool PartialSightings::Cross(const Ray& a, const Ray& b, double* point) {
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

bool PartialSightings::Place(double* landmark) const {
  double ahead[2];
  const Ray& first = rays_.empty() ? range_from_ : rays_.front();
  const Ray* best = nullptr;
  double best_crossing = kSmallestCrossing;
  for (const Ray& ray : rays_) {
    double candidate[2];
    const double crossing = std::abs(std::sin(ray.heading_rad - first.heading_rad));
    if (crossing > best_crossing && Cross(first, ray, candidate)) {
      best_crossing = crossing;
      best = &ray;
    }
  }
  if (best) return Cross(first, *best, landmark);
  const double pose[3] = {first.x_m, first.y_m, first.heading_rad};
  Polar(range_m_ >= 0 ? range_m_ : kAssumedRangeM, 0, ahead);
  TransformPoint(true, pose, ahead, landmark);
  return false;
}

}  // namespace graticule
