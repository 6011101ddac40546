#include "graticule/problems/mapping/timed_truth.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Pose = std::array<double, 7>;  // x y z qx qy qz qw

Pose Between(const Pose& from, const Pose& to, double part) {
  Pose pose;
  for (std::size_t i = 0; i < 3; ++i) pose[i] = from[i] + part * (to[i] - from[i]);
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(from[6], from[3], from[4], from[5])
          .slerp(part, Eigen::Quaterniond(to[6], to[3], to[4], to[5]));
  for (Eigen::Index i = 0; i < 4; ++i) pose[static_cast<std::size_t>(3 + i)] = turned.coeffs()[i];
  return pose;
}

std::optional<Pose> At(const std::vector<StampedPose>& truth, double time) {
  constexpr double kSame_s = 1e-3, kMostApart_s = 2;
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), time,
                       [](const StampedPose& pose, double stamp) { return pose.stamp_s < stamp; });
  if (after != truth.end() && after->stamp_s - time <= kSame_s) return after->world_from_body;
  if (after == truth.begin()) return std::nullopt;
  const StampedPose& before = *(after - 1);
  if (time - before.stamp_s <= kSame_s) return before.world_from_body;
  if (after == truth.end() || after->stamp_s - before.stamp_s > kMostApart_s) return std::nullopt;
  return Between(before.world_from_body, after->world_from_body,
                 (time - before.stamp_s) / (after->stamp_s - before.stamp_s));
}

}  // namespace

std::vector<TrajectoryPair> PairByTime(
    const Mission& mission, const MissionStep& step,
    const std::map<std::string, std::vector<StampedPose>>& truth) {
  std::vector<TrajectoryPair> pairs;
  for (const std::string& robot : mission.log.robots) pairs.push_back({robot, 0, {}, {}});
  std::size_t matched = 0;
  for (std::size_t i = 0; i < step.nodes; ++i) {
    const LaserScan& scan = mission.log.scans[mission.nodes[i].scan];
    TrajectoryPair& pair = pairs[scan.robot];
    ++pair.poses;
    const auto known = truth.find(pair.family);
    if (known == truth.end()) continue;
    const std::optional<Pose> at = At(known->second, scan.time);
    if (!at) continue;
    pair.truth.push_back(*at);
    pair.estimate.push_back(StampPlanar(scan.time, step.world_from_robot[i]).world_from_body);
    ++matched;
  }
  if (matched == 0)
    throw Error("no true pose is of a time when the logs have one", ErrorKind::kUsage);
  return pairs;
}

}  // namespace graticule
