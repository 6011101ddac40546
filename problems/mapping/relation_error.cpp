#include "graticule/problems/mapping/relation_error.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

constexpr double kSameTime = 1e-3;  // s

bool PoseAt(const std::vector<TimedPose>& poses, double time, double farthest_s, PlanarPose* pose) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), time,
                       [](const TimedPose& entry, double limit) { return entry.time < limit; });
  const TimedPose* const b = after == poses.end() ? nullptr : &*after;
  const TimedPose* const a = after == poses.begin() ? nullptr : &*(after - 1);
  const double to_a = a ? time - a->time : HUGE_VAL, to_b = b ? b->time - time : HUGE_VAL;
  if (std::min(to_a, to_b) > farthest_s) return false;
  if (!a || !b || std::min(to_a, to_b) <= kSameTime || std::max(to_a, to_b) > farthest_s) {
    *pose = (to_a <= to_b ? a : b)->world_from_robot;
    return true;
  }
  *pose = Interpolated(a->world_from_robot, b->world_from_robot, to_a / (to_a + to_b));
  return true;
}

ErrorMoments MomentsOf(const std::vector<double>& values) {
  ErrorMoments moments;
  const double count = static_cast<double>(std::max<std::size_t>(values.size(), 1));
  for (const double value : values) moments.mean += value / count;
  double variance = 0;
  for (const double value : values)
    variance += (value - moments.mean) * (value - moments.mean) / count;
  moments.deviation = std::sqrt(variance);
  return moments;
}

std::vector<double> Squared(std::vector<double> values) {
  for (double& value : values) value *= value;
  return values;
}

}  // namespace

RelationError CompareWithRelations(std::vector<TimedPose> poses,
                                   const std::vector<PoseRelation>& relations, double farthest_s) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.time < b.time; });
  RelationError error;
  std::vector<double> translations, rotations;
  for (const PoseRelation& relation : relations) {
    PlanarPose a, b;
    if (!PoseAt(poses, relation.time_a, farthest_s, &a) ||
        !PoseAt(poses, relation.time_b, farthest_s, &b)) {
      ++error.unmatched;
      continue;
    }
    const PlanarPose apart = Inverse(relation.a_from_b) * (Inverse(a) * b);
    translations.push_back(std::hypot(apart.x, apart.y));
    rotations.push_back(std::abs(apart.yaw));
  }
  error.relations = translations.size();
  error.translation_m = MomentsOf(translations);
  error.rotation_rad = MomentsOf(rotations);
  error.squared_translation = MomentsOf(Squared(std::move(translations)));
  error.squared_rotation = MomentsOf(Squared(std::move(rotations)));
  return error;
}

}  // namespace graticule
