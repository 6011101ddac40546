#include "graticule/problems/mapping/front_end.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/factors/make.hpp"
#include "graticule/problems/mapping/loop_search.hpp"
#include "graticule/problems/mapping/pose_noise.hpp"
#include "graticule/problems/mapping/scan_track.hpp"
#include "graticule/problems/pose_graph/robustify.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

constexpr double kFirstWindow = 2;  // m

class Builder {
 public:
  Builder(const LaserLog& log, const Registry& types, const FrontEndOptions& options,
          const FrontEndObserver& watch)
      : log_(log), options_(options), watch_(watch), mission_(types) {}

  Mission Build() {
    if (log_.scans.empty()) throw Error("there is no scan in this log");
    Stopwatch watch;
    Follow();
    AddChain();
    mission_.report.seconds_follow = watch.Lap().wall;
    LoopSearch search(nodes_, options_);
    Close(&search);
    mission_.report.seconds_close = watch.Lap().wall;
    Refine(&search);
    PlaceScans();
    mission_.report.seconds_refine = watch.Lap().wall;
    return std::move(mission_);
  }

 private:
  void Tell(const std::string& stage, double done) const {
    if (watch_) watch_(stage, done);
  }

  void Follow() {
    for (std::uint32_t robot = 0; robot < log_.robots.size(); ++robot) {
      Track track = FollowScans(log_, robot, options_, [&](double done) {
        Tell("following " + log_.robots[robot], done);
      });
      first_node_.push_back(nodes_.size());
      for (TrackNode& node : track.nodes) nodes_.push_back(std::move(node));
      track.nodes.clear();
      tracks_.push_back(std::move(track));
    }
    first_node_.push_back(nodes_.size());
    for (const TrackNode& node : nodes_) poses_.push_back(node.pose);
    mission_.report.scans = log_.scans.size();
    mission_.report.nodes = nodes_.size();
  }

  // Poses, dead reckoning and matches along each robot's way.
  void AddChain() {
    Graph& graph = mission_.graph;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const TrackNode& node = nodes_[i];
      const Key key(log_.robots[node.robot], i - first_node_[node.robot]);
      mission_.nodes.push_back({key, node.scan});
      graph.Add(key, "se2/1", {node.pose.x, node.pose.y, node.pose.yaw}, i == 0);
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const TrackNode& node = nodes_[i];
      if (node.is_first) continue;
      const MotionSigmas sigmas = SigmasOf(node.odometry_step, options_);
      AddBetween(i - 1, i, node.odometry_step,
                 Noise::Sigmas({sigmas.sigma, sigmas.sigma, sigmas.sigma_yaw}), "odometry");
      AddBetween(i - 1, i, node.match_step, InformationNoise(MatchInformation(node, options_)),
                 "scan");
    }
    chain_factors_ = graph.FactorCount();
  }

  void AddBetween(std::size_t a, std::size_t b, const PlanarPose& a_from_b, Noise noise,
                  const char* source) {
    mission_.graph.Add(BetweenSe2Factor(mission_.nodes[a].key, mission_.nodes[b].key,
                                        {a_from_b.x, a_from_b.y, a_from_b.yaw}, std::move(noise),
                                        source));
  }

  Graph WithClosures(const std::vector<Closure>& closures) {
    Graph before = mission_.graph;
    for (const Closure& closure : closures)
      AddBetween(closure.a, closure.b, closure.a_from_b, InformationNoise(closure.information),
                 "loop");
    std::swap(before, mission_.graph);
    return before;
  }

  void TakePoses(const Values& values) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Span<const double> value = values.At(mission_.nodes[i].key);
      poses_[i] = {value[0], value[1], value[2]};
    }
    mission_.graph.SetValues(values);
  }

  void Close(LoopSearch* search) {
    std::vector<Closure> suspects;
    double window = std::min(kFirstWindow, options_.closure_window);
    for (int round = 0; round < options_.closure_rounds; ++round) {
      Tell("closing loops", static_cast<double>(round) / options_.closure_rounds);
      bool has_left = false;
      const std::vector<Closure> found = search->Search(poses_, believed_, window, &has_left);
      // Only where near things are settled is it worth looking far.
      if (found.size() * 50 <= suspects.size()) {
        if (found.empty() && !has_left) break;
        window = std::min(2 * window, options_.closure_window);
      }
      if (found.empty()) continue;
      suspects.insert(suspects.end(), found.begin(), found.end());
      const Graph graph = WithClosures(suspects);
      RejectionOptions rejection;
      rejection.reject_outliers = Rejection::kGncTls;
      rejection.trusted_sources = "odometry,scan";
      const RobustSolution robust = SolveWithoutOutliers(graph, rejection, options_.solve);
      believed_.clear();
      for (std::size_t i = 0; i < suspects.size(); ++i)
        if (robust.is_kept[chain_factors_ + i]) believed_.push_back(suspects[i]);
      TakePoses(robust.solution.values);
      ++mission_.report.rounds;
      if (getenv("DBG"))
        printf("round %d window %.1f found %zu of %zu searches, suspects %zu kept %zu  gnc %.2f s cost %.1f\n", round, window, has_left, found.size(), search->Searches(),
               suspects.size(), believed_.size(), robust.rejection.seconds, robust.solution.report.final_cost);
    }
    mission_.report.searches = search->Searches();
    mission_.report.found = suspects.size();
    mission_.report.rejected = suspects.size() - believed_.size();
  }

  void Refine(LoopSearch* search) {
    std::vector<Closure> overlaps;
    for (int round = 0; round < options_.overlap_rounds; ++round) {
      Tell("refining", static_cast<double>(round) / options_.overlap_rounds);
      overlaps = search->Overlaps(poses_);
      std::vector<Closure> all = believed_;
      all.insert(all.end(), overlaps.begin(), overlaps.end());
      Graph graph = WithClosures(all);
      for (auto id = static_cast<FactorId>(chain_factors_); id < graph.FactorCount(); ++id)
        graph.SetLoss(id, Loss{LossKind::kCauchy, 1.0});
      const Solution solution = Solve(graph, options_.solve);
      if (getenv("DBG"))
        printf("overlaps %zu cost %.1f -> %.1f\n", overlaps.size(), solution.report.initial_cost, solution.report.final_cost);
      TakePoses(solution.values);
      if (round + 1 == options_.overlap_rounds) {
        graph.SetValues(solution.values);
        mission_.graph = std::move(graph);
      }
    }
    mission_.report.overlaps = overlaps.size();
    mission_.world_from_node = poses_;
  }

  // Between two nodes, what the solution moved them by fades from the one to the other.
  void PlaceScans() {
    mission_.world_from_scan.resize(log_.scans.size());
    for (std::uint32_t robot = 0; robot < log_.robots.size(); ++robot) {
      const Track& track = tracks_[robot];
      const std::size_t last = first_node_[robot + 1];
      std::size_t node = first_node_[robot];
      for (std::size_t i = 0; i < track.scans.size(); ++i) {
        const std::size_t scan = track.scans[i];
        while (node + 1 < last && nodes_[node + 1].scan <= scan) ++node;
        PlanarPose pose = poses_[node] * (Inverse(nodes_[node].pose) * track.scan_poses[i]);
        if (node + 1 < last && scan > nodes_[node].scan) {
          const PlanarPose other =
              poses_[node + 1] * (Inverse(nodes_[node + 1].pose) * track.scan_poses[i]);
          const double part = static_cast<double>(scan - nodes_[node].scan) /
                              static_cast<double>(nodes_[node + 1].scan - nodes_[node].scan);
          pose = {pose.x + part * (other.x - pose.x), pose.y + part * (other.y - pose.y),
                  WrappedAngle(pose.yaw + part * WrappedAngle(other.yaw - pose.yaw))};
        }
        mission_.world_from_scan[scan] = pose;
      }
    }
  }

  const LaserLog& log_;
  const FrontEndOptions& options_;
  const FrontEndObserver& watch_;
  Mission mission_;
  std::vector<TrackNode> nodes_;
  std::vector<std::size_t> first_node_;  // of each robot, and the end
  std::vector<Track> tracks_;            // without their nodes
  std::vector<PlanarPose> poses_;        // of nodes, as of the last solution
  std::vector<Closure> believed_;
  std::size_t chain_factors_ = 0;
};

}  // namespace

Mission BuildMission(const LaserLog& log, const Registry& types, const FrontEndOptions& options,
                     const FrontEndObserver& watch) {
  return Builder(log, types, options, watch).Build();
}

}  // namespace graticule
