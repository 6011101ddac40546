#include "graticule/problems/calibration/simulated_person.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "graticule/problems/calibration/target_pose.hpp"

namespace graticule {
namespace {

// Where the target's picture matches the suggested one best.
Se3Array Matched(const Suggestion& suggestion, const Camera& truth) {
  constexpr double kAnyDistance = 1e6;  // px: no corner is an outlier
  CornerPairs pairs;
  for (const DetectedCorner& corner : suggestion.corners) {
    pairs.in_target.emplace_back(corner.in_target.data());
    pairs.pixels.emplace_back(corner.pixel[0], corner.pixel[1]);
  }
  const auto pose = FindTargetPose(truth, pairs, kAnyDistance);
  return pose ? PoseOf(pose->camera_from_target) : suggestion.camera_from_target;
}

HandNoise Scaled(const HandNoise& noise, double by) {
  return {noise.across * by, noise.distance * by, noise.turn_rad * by};
}

}  // namespace

SimulatedPerson::SimulatedPerson(const Camera& truth, const TargetLayout& target,
                                 const PersonOptions& options)
    : truth_(truth), target_(target), options_(options), random_(options.seed) {
  Placement start;
  start.size = 0.35;
  start.tilt_up = 0.2;
  start.tilt_sideways = -0.2;
  now_ = PlaceTarget(truth_, target_, start).value_or(kIdentityPose);
  goal_ = now_;
}

Se3Array SimulatedPerson::Step(const std::optional<Suggestion>& suggestion, std::size_t number,
                               double seconds) {
  since_look_s_ += seconds;
  if (suggestion && number_ != number) {
    number_ = number;
    wanted_ = Matched(*suggestion, truth_);
    noise_ = 1;
    since_look_s_ = options_.look_s;
  }
  if (wanted_ && since_look_s_ >= options_.look_s) {
    goal_ = HeldAt(*wanted_, truth_, target_, Scaled(options_.hands, noise_), random_);
    noise_ *= options_.correction;
    since_look_s_ = 0;
  }
  const double share = 1 - std::exp(-seconds / options_.reach_s);
  const Eigen::Vector3d centre = target_.Centre();
  const Eigen::Isometry3d from = IsometryOf(now_), to = IsometryOf(goal_);
  Eigen::Isometry3d next = Eigen::Isometry3d::Identity();
  next.linear() = Eigen::Quaterniond(from.linear())
                      .slerp(share, Eigen::Quaterniond(to.linear()))
                      .toRotationMatrix();
  const Eigen::Vector3d place = from * centre + share * (to * centre - from * centre);
  next.translation() = place - next.linear() * centre;
  now_ = PoseOf(next);
  const double tremor = options_.tremor / options_.hands.across;
  return HeldAt(now_, truth_, target_, Scaled(options_.hands, tremor), random_);
}

}  // namespace graticule
