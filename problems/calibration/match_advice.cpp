#include "graticule/problems/calibration/match_advice.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/calibration/target_pose.hpp"

namespace graticule {
namespace {

constexpr double kHuberPx = 3;
constexpr int kIterations = 8;
constexpr double kSaidFromCells = 0.5;
constexpr double kPitchCells = 10;  // from tag to tag of a mosaic

// Of corners of a target whose camera is only nearly known.
std::optional<Eigen::Isometry3d> PoseOfView(const Camera& camera,
                                            const std::vector<DetectedCorner>& corners) {
  CornerPairs pairs;
  for (const DetectedCorner& corner : corners) {
    pairs.in_target.emplace_back(corner.in_target.data());
    pairs.pixels.emplace_back(corner.pixel[0], corner.pixel[1]);
  }
  const auto pose = FindTargetPose(camera, pairs, kHuberPx, kIterations);
  if (!pose) return std::nullopt;
  return pose->camera_from_target;
}

}  // namespace

const char* WordsOf(TargetMove move) {
  constexpr const char* kWords[] = {
      "right",     "left",    "down",      "up",         "farther",        "closer",
      "tilt down", "tilt up", "tilt left", "tilt right", "turn clockwise", "turn anticlockwise"};
  return kWords[static_cast<std::size_t>(move)];
}

SuggestionMatcher::SuggestionMatcher(const Camera& camera, const TargetLayout& target,
                                     const Suggestion& suggestion)
    : camera_(camera), target_(target), suggested_(IsometryOf(suggestion.camera_from_target)) {
  const std::size_t each = target_.corners_per_tag;
  for (std::size_t tag = 0; tag < target_.Tags(); ++tag) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (std::size_t i = tag * each; i < (tag + 1) * each; ++i) {
      tag_of_[target_.corners[i].id] = tag;
      centre += Eigen::Vector3d(target_.corners[i].in_target.data()) / static_cast<double>(each);
    }
    tags_.push_back(centre);
  }
  centres_ = CentresOf(suggestion.corners);
  double sum = 0;
  std::size_t count = 0;
  for (const auto& [tag, centre] : centres_) {
    double nearest = HUGE_VAL;
    for (const auto& [other, place] : centres_)
      if (other != tag) nearest = std::min(nearest, (place - centre).norm());
    if (!std::isfinite(nearest)) continue;
    sum += nearest;
    ++count;
  }
  if (count > 0) cell_px_ = std::max(0.5, sum / static_cast<double>(count) / kPitchCells);
}

// Of tags all of whose corners are there.
SuggestionMatcher::Centres SuggestionMatcher::CentresOf(
    const std::vector<DetectedCorner>& corners) const {
  std::map<std::size_t, std::pair<std::size_t, Eigen::Vector2d>> sums;
  for (const DetectedCorner& corner : corners) {
    const auto tag = tag_of_.find(corner.id);
    if (tag == tag_of_.end()) continue;
    auto& [count, sum] = sums.try_emplace(tag->second, 0, Eigen::Vector2d::Zero()).first->second;
    ++count;
    sum += Eigen::Vector2d(corner.pixel[0], corner.pixel[1]);
  }
  Centres centres;
  for (const auto& [tag, sum] : sums)
    if (sum.first == target_.corners_per_tag)
      centres[tag] = sum.second / static_cast<double>(sum.first);
  return centres;
}

Match SuggestionMatcher::Compare(const std::vector<DetectedCorner>& live) const {
  Match match;
  const Centres seen = CentresOf(live);
  double sum = 0;
  for (const auto& [tag, centre] : seen) {
    const auto there = centres_.find(tag);
    if (there == centres_.end()) continue;
    ++match.shared;
    sum += (there->second - centre).norm();
  }
  if (match.shared >= std::max(centres_.size() / 3, std::min<std::size_t>(4, centres_.size())) &&
      match.shared > 0) {
    match.distance_px = sum / static_cast<double>(match.shared);
    match.distance_cells = match.distance_px / cell_px_;
  }
  const auto pose = PoseOfView(camera_, live);
  if (!pose) return match;
  match.camera_from_target = PoseOf(*pose);
  match.moves = Moves(*pose);
  return match;
}

// Each of six motions by itself, from where the target is: how far it would move the tags.
std::vector<TargetMove> SuggestionMatcher::Moves(const Eigen::Isometry3d& now) const {
  const Eigen::Vector3d centre = target_.Centre();
  const Eigen::Vector3d from = now * centre, to = suggested_ * centre;
  if (!(from.norm() > 0 && to.norm() > 0)) return {};
  // Right, down and away as one sees them along the ray to where the target should be.
  const Eigen::Vector3d away = to.normalized();
  Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(away);
  right = right.norm() > 1e-6 ? right.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d down = away.cross(right);
  const Eigen::Vector3d step = to.normalized() * from.norm() - from;  // at the same distance
  const double nearer = to.norm() / from.norm();
  const Eigen::AngleAxisd turn(suggested_.linear() * now.linear().transpose());
  const Eigen::Vector3d turns = turn.angle() * turn.axis();

  const auto turned = [&](const Eigen::Vector3d& axis) {
    Eigen::Isometry3d pose = now;
    pose.linear() = Eigen::AngleAxisd(turns.dot(axis), axis).toRotationMatrix() * now.linear();
    pose.translation() = from - pose.linear() * centre;
    return pose;
  };
  const auto moved = [&](const Eigen::Vector3d& by) {
    Eigen::Isometry3d pose = now;
    pose.translation() += by;
    return pose;
  };
  const auto effect_px = [&](const Eigen::Isometry3d& pose) {
    double sum = 0;
    std::size_t count = 0;
    for (const Eigen::Vector3d& tag : tags_) {
      const auto before = camera_.Project(now * tag), after = camera_.Project(pose * tag);
      if (!before || !after) continue;
      sum += (*after - *before).norm();
      ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : 0;
  };
  struct Motion {
    double amount;  // its sign chooses
    Eigen::Isometry3d pose;
    TargetMove if_positive, if_negative;
  };
  // A turn about `down` by the right hand's rule brings the right edge nearer; one about `right`
  // takes the lower edge away; one about `away` takes the right edge down.
  const Motion motions[] = {
      {step.dot(right), moved(step.dot(right) * right), TargetMove::kRight, TargetMove::kLeft},
      {step.dot(down), moved(step.dot(down) * down), TargetMove::kDown, TargetMove::kUp},
      {nearer - 1, moved((nearer - 1) * from), TargetMove::kFarther, TargetMove::kCloser},
      {turns.dot(right), turned(right), TargetMove::kTiltDown, TargetMove::kTiltUp},
      {turns.dot(down), turned(down), TargetMove::kTiltLeft, TargetMove::kTiltRight},
      {turns.dot(away), turned(away), TargetMove::kTurnClockwise, TargetMove::kTurnAnticlockwise}};
  std::vector<std::pair<double, TargetMove>> said;
  for (const Motion& motion : motions) {
    const double px = effect_px(motion.pose);
    if (px >= kSaidFromCells * cell_px_)
      said.emplace_back(px, motion.amount > 0 ? motion.if_positive : motion.if_negative);
  }
  std::stable_sort(said.begin(), said.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<TargetMove> moves;
  for (const auto& [px, move] : said) moves.push_back(move);
  return moves;
}

}  // namespace graticule
