#include "graticule/problems/calibration/suggest.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "graticule/problems/calibration/view_information.hpp"

namespace graticule {
namespace {

constexpr double kTilt = 0.6;  // rad, of candidates

// A pose moved by six numbers: its centre along the camera's axes [distances], and turned about
// it [rad].
Se3Array Moved(const Se3Array& pose, const TargetLayout& target,
               const Eigen::Matrix<double, 6, 1>& by) {
  Eigen::Isometry3d moved = IsometryOf(pose);
  const Eigen::Vector3d centre = target.Centre(), place = moved * centre;
  const Eigen::Vector3d turn = by.tail<3>();
  const double angle = turn.norm();
  if (angle > 0)
    moved.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * moved.linear();
  moved.translation() = place + place.norm() * by.head<3>() - moved.linear() * centre;
  return PoseOf(moved);
}

Suggestion At(const Camera& camera, const TargetLayout& target, const Se3Array& pose,
              const SuggestOptions& options, double score) {
  return {pose, VisibleCorners(camera, target, pose, {}, options.detectability), score};
}

}  // namespace

std::vector<Placement> CandidatePlacements() {
  std::vector<Placement> placements;
  constexpr double kPlaces[] = {0.12, 0.5, 0.88};
  for (const double size : {0.45, 0.9})
    for (const double down : kPlaces)
      for (const double across : kPlaces) {
        Placement p;
        p.across = across;
        p.down = down;
        p.size = size;
        placements.push_back(p);
        // Away from the middle, the side that is nearer to it tilts either way in turn.
        const bool is_middle = across == 0.5 && down == 0.5;
        const double sideways = across > 0.5 ? -kTilt : kTilt, up = down > 0.5 ? kTilt : -kTilt;
        p.tilt_sideways = sideways;
        placements.push_back(p);
        if (is_middle) {
          p.tilt_sideways = -sideways;
          placements.push_back(p);
        }
        p.tilt_sideways = 0;
        p.tilt_up = up;
        placements.push_back(p);
        if (!is_middle) continue;
        p.tilt_up = -up;
        placements.push_back(p);
        p.tilt_sideways = p.tilt_up = kTilt / std::sqrt(2.);
        p.roll = M_PI / 4;
        placements.push_back(p);
      }
  return placements;
}

Eigen::MatrixXd InformationOfCamera(const Posterior& posterior, std::size_t camera) {
  const PosteriorBlock& block = posterior.Block("camera:" + std::to_string(camera));
  const Eigen::Index n = block.Size(), others = posterior.information.rows() - n;
  if (others == 0) return posterior.information;
  // Schur complement of the others; a little of their scale lets them be singular.
  std::vector<Eigen::Index> rest;
  for (Eigen::Index i = 0; i < posterior.information.rows(); ++i)
    if (i < block.offset || i >= block.offset + n) rest.push_back(i);
  Eigen::MatrixXd corner(others, others), cross(others, n);
  for (Eigen::Index i = 0; i < others; ++i) {
    for (Eigen::Index j = 0; j < others; ++j)
      corner(i, j) = posterior.information(rest[i], rest[j]);
    corner(i, i) += 1e-6 / (posterior.scales[rest[i]] * posterior.scales[rest[i]]);
    for (Eigen::Index j = 0; j < n; ++j)
      cross(i, j) = posterior.information(rest[i], block.offset + j);
  }
  return posterior.information.block(block.offset, block.offset, n, n) -
         cross.transpose() * corner.ldlt().solve(cross);
}

PoseScorer::PoseScorer(const Camera& camera, const TargetLayout& target,
                       const Eigen::MatrixXd& information, const Eigen::VectorXd& scales,
                       const SuggestOptions& options)
    : camera_(camera),
      target_(target),
      information_(information),
      scales_(scales),
      options_(options),
      grid_(camera, options.ere) {}

double PoseScorer::Score(const Se3Array& camera_from_target) const {
  const Eigen::Isometry3d pose = IsometryOf(camera_from_target);
  const Eigen::Vector3d centre = pose * target_.Centre();
  const Eigen::Vector3d normal =
      pose.linear().col(2) * (target_.printed_towards_z ? -1 : 1);  // away from the camera
  if (centre.norm() < 0.2 * target_.Width()) return HUGE_VAL;
  if (!(normal.dot(centre) >= std::cos(options_.steepest_rad) * centre.norm())) return HUGE_VAL;
  const std::vector<DetectedCorner> seen =
      VisibleCorners(camera_, target_, camera_from_target, {}, options_.detectability);
  if (seen.size() < target_.corners_per_tag * std::min(options_.fewest_tags, target_.Tags()))
    return HUGE_VAL;

  ViewInformation frame(camera_.Model(), {});
  frame.Start(camera_.Intrinsics().parameters.data(), Eigen::Isometry3d::Identity(), pose);
  for (const DetectedCorner& corner : seen) frame.Add(Eigen::Vector3d(corner.in_target.data()));
  return grid_.MaxPx(
      ClampedInverse(information_ + frame.OfParameters() / (options_.sigma_px * options_.sigma_px),
                     scales_, options_.loose, nullptr));
}

std::vector<Suggestion> ScoreCandidates(const Camera& camera, const TargetLayout& target,
                                        const Eigen::MatrixXd& information,
                                        const Eigen::VectorXd& scales,
                                        const SuggestOptions& options) {
  const PoseScorer scorer(camera, target, information, scales, options);
  std::vector<Suggestion> suggestions;
  for (const Placement& placement : CandidatePlacements()) {
    const auto pose = PlaceTarget(camera, target, placement);
    if (!pose) continue;
    const double score = scorer.Score(*pose);
    if (std::isfinite(score)) suggestions.push_back({*pose, {}, score});
  }
  std::stable_sort(
      suggestions.begin(), suggestions.end(),
      [](const Suggestion& a, const Suggestion& b) { return a.max_ere_px < b.max_ere_px; });
  return suggestions;
}

std::optional<Suggestion> SuggestPose(const Camera& camera, const TargetLayout& target,
                                      const Eigen::MatrixXd& information,
                                      const Eigen::VectorXd& scales,
                                      const SuggestOptions& options) {
  const std::vector<Suggestion> candidates =
      ScoreCandidates(camera, target, information, scales, options);
  if (candidates.empty()) return std::nullopt;
  const PoseScorer scorer(camera, target, information, scales, options);
  Se3Array best = candidates.front().camera_from_target;
  double least = candidates.front().max_ere_px;
  double step = 0.15;
  for (int tried = 0; tried < options.refinements && step > 0.005;) {
    bool is_better = false;
    for (int i = 0; i < 6 && tried < options.refinements; ++i)
      for (const double sign : {1., -1.}) {
        Eigen::Matrix<double, 6, 1> by = Eigen::Matrix<double, 6, 1>::Zero();
        by[i] = sign * step;
        const Se3Array pose = Moved(best, target, by);
        const double score = scorer.Score(pose);
        ++tried;
        if (!(score < least)) continue;
        least = score;
        best = pose;
        is_better = true;
        break;
      }
    if (!is_better) step /= 2;
  }
  return At(camera, target, best, options, least);
}

std::optional<Suggestion> SuggestFirstPose(const Camera& camera, const TargetLayout& target,
                                           std::size_t frame, const SuggestOptions& options) {
  Placement placement;
  placement.size = 0.7;
  (frame % 2 == 0 ? placement.tilt_sideways : placement.tilt_up) = kTilt;
  const auto pose = PlaceTarget(camera, target, placement);
  if (!pose) return std::nullopt;
  return At(camera, target, *pose, options, 0);
}

CameraIntrinsics GuessedCamera(const ImageSize& size) {
  const double focal = 0.75 * size.width;
  return {size.camera,
          "angular4",
          size.width,
          size.height,
          {focal, focal, (size.width - 1) / 2., (size.height - 1) / 2., 0, 0, 0, 0}};
}

}  // namespace graticule
