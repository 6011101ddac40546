#include "graticule/problems/mapping/scan_track.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/mapping/point_refine.hpp"
#include "graticule/problems/mapping/scan_match.hpp"

namespace graticule {
namespace {

constexpr double kCell = 0.05, kBlur = 0.07;  // m, of the grid
constexpr double kResidualSigma = 0.03;       // m, against dead reckoning
constexpr double kResidualScale = 0.1;        // m
// Windows are never smaller than these, nor larger.
constexpr double kLeastReach = 0.2, kLargestReach = 1.5;         // m
constexpr double kLeastReachYaw = 0.35, kLargestReachYaw = 0.8;  // rad
// Where no pose near dead reckoning has this mean likelihood, a wider window is tried, and believed
// where it is better by so much.
constexpr double kSureScore = 0.75, kWider = 2.5, kBetterScore = 0.1;
constexpr double kContradiction = 9;  // of the squared Mahalanobis distance to dead reckoning
constexpr double kStillMetres = 1e-3, kStillTurn = 1e-3;
constexpr int kStillScans = 3;  // so many are matched after the wheels have stopped

// Of nodes before the local ones, some hold the heading: every so many, so many times as far back.
constexpr std::size_t kOlderStep = 5, kOlderReach = 6;

class Follower {
 public:
  Follower(const LaserLog& log, const FrontEndOptions& options) : log_(log), options_(options) {
    surface_.max_range = options.max_range;
    surface_.spacing = options.point_spacing;
  }

  void Follow(std::size_t scan) {
    const PlanarPose& odometry = log_.scans[scan].odom_from_robot;
    if (track_.nodes.empty()) {
      Begin(scan);
    } else {
      const PlanarPose step = Inverse(odometry_) * odometry;
      still_ = std::hypot(step.x, step.y) < kStillMetres && std::abs(step.yaw) < kStillTurn
                   ? still_ + 1
                   : 0;
      if (still_ <= kStillScans) Match(scan, step);
    }
    odometry_ = odometry;
    track_.scans.push_back(scan);
    track_.scan_poses.push_back(pose_);
  }

  Track Take() { return std::move(track_); }

 private:
  void Begin(std::size_t scan) {
    TrackNode node;
    node.is_first = true;
    node.points = SurfacePoints(log_, log_.scans[scan], surface_);
    Add(std::move(node), scan);
  }

  void Match(std::size_t scan, const PlanarPose& step) {
    std::vector<SurfacePoint> points = SurfacePoints(log_, log_.scans[scan], surface_);
    const PlanarPose last = track_.nodes.back().pose;
    const PlanarPose guess = Inverse(last) * pose_ * step;
    MotionSigmas sigmas = SigmasOf(step, options_);
    graticule::Match match = Search(points, guess, sigmas, 1);
    if (match.score < kSureScore) {  // wheels may have slipped, or counted backwards as forwards
      const graticule::Match wide = Search(points, guess, sigmas, kWider);
      if (wide.score > match.score + kBetterScore) match = wide;
    }
    // What the wheels say counts less where the scans contradict it.
    const PlanarPose apart = Inverse(guess) * match.reference_from_scan;
    const double squared = std::pow(std::hypot(apart.x, apart.y) / sigmas.sigma, 2) +
                           std::pow(apart.yaw / sigmas.sigma_yaw, 2);
    const double weight = 1 / (1 + squared / kContradiction);
    Eigen::Matrix3d prior = Eigen::Matrix3d::Zero();
    prior.diagonal() << weight / std::pow(sigmas.sigma, 2), weight / std::pow(sigmas.sigma, 2),
        weight / std::pow(sigmas.sigma_yaw, 2);
    RefineOptions refine;
    refine.scale = kResidualScale;
    const Refinement refined = RefineOnPoints(index_, points, match.reference_from_scan, guess,
                                              prior, kResidualSigma, refine);
    worst_matched_ = std::min(worst_matched_, refined.matched);
    const PlanarPose& in_last = refined.reference_from_scan;
    pose_ = last * in_last;
    if (std::hypot(in_last.x, in_last.y) < options_.node_distance &&
        std::abs(in_last.yaw) < options_.node_turn)
      return;
    TrackNode node;
    node.match_step = in_last;
    node.information = refined.information;
    node.matched = worst_matched_;
    worst_matched_ = 1;
    node.points = std::move(points);
    node.travelled = track_.nodes.back().travelled + std::hypot(in_last.x, in_last.y);
    Add(std::move(node), scan);
  }

  graticule::Match Search(const std::vector<SurfacePoint>& points, const PlanarPose& guess,
                          const MotionSigmas& sigmas, double wider) {
    SearchWindow window;
    window.guess = guess;
    window.reach = std::clamp(3 * sigmas.sigma, kLeastReach, kLargestReach) * wider;
    window.reach_yaw = std::clamp(4 * sigmas.sigma_yaw, kLeastReachYaw, kLargestReachYaw) * wider;
    window.sigma = sigmas.sigma * wider;
    window.sigma_yaw = sigmas.sigma_yaw * wider;
    graticule::Match match;
    match.reference_from_scan = guess;
    matcher_.Search(grid_, points, window, 0, &match);
    return match;
  }

  void Add(TrackNode node, std::size_t scan) {
    const LaserScan& own = log_.scans[scan];
    node.scan = scan;
    node.robot = own.robot;
    node.pose = pose_;
    if (!track_.nodes.empty())
      node.odometry_step =
          Inverse(log_.scans[track_.nodes.back().scan].odom_from_robot) * own.odom_from_robot;
    track_.nodes.push_back(std::move(node));
    between_.push_back(PointsBetween(log_, own, surface_));

    // What the next scans are matched against, in this node's frame.
    const std::vector<TrackNode>& nodes = track_.nodes;
    reference_.clear();
    const auto recent = static_cast<std::size_t>(options_.local_nodes);
    for (std::size_t back = 0; back < nodes.size() && back < kOlderReach * recent;
         back += back + 1 < recent ? 1 : kOlderStep) {
      const TrackNode& own_node = nodes[nodes.size() - 1 - back];
      const PlanarPose pose_from_own = Inverse(pose_) * own_node.pose;
      AppendTransformed(own_node.points, pose_from_own, &reference_);
      AppendTransformed(between_[nodes.size() - 1 - back], pose_from_own, &reference_);
    }
    grid_.Build(reference_, 0, 0, options_.max_range + 1);
    index_.Build(reference_);
  }

  const LaserLog& log_;
  const FrontEndOptions& options_;
  SurfaceOptions surface_;
  Track track_;
  PlanarPose pose_, odometry_;
  int still_ = 0;
  double worst_matched_ = 1;                        // since the last node
  std::vector<std::vector<SurfacePoint>> between_;  // of each node, what its readings leave out
  std::vector<SurfacePoint> reference_;
  LikelihoodGrid grid_{kCell, kBlur};
  CorrelativeMatcher matcher_;
  PointIndex index_;
};

}  // namespace

MotionSigmas SigmasOf(const PlanarPose& step, const FrontEndOptions& options) {
  const double distance = std::hypot(step.x, step.y), turn = std::abs(step.yaw);
  return {options.odometry_sigma + options.odometry_sigma_per_metre * distance,
          options.odometry_sigma_yaw + options.odometry_sigma_per_turn * turn};
}

Track FollowScans(const LaserLog& log, std::uint32_t robot, const FrontEndOptions& options,
                  const std::function<void(double)>& progress) {
  Follower follower(log, options);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (log.scans[i].robot == robot) follower.Follow(i);
    if (progress && i % 256 == 0)
      progress(static_cast<double>(i) / static_cast<double>(log.scans.size()));
  }
  return follower.Take();
}

}  // namespace graticule
