#include "graticule/problems/mapping/front_end.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "graticule/factors/make.hpp"
#include "graticule/problems/mapping/live_map.hpp"
#include "graticule/problems/mapping/loop_search.hpp"
#include "graticule/problems/mapping/planar_values.hpp"
#include "graticule/problems/mapping/pose_noise.hpp"
#include "graticule/problems/mapping/scan_track.hpp"
#include "graticule/problems/mapping/sight_conflict.hpp"
#include "graticule/problems/pose_graph/consistency.hpp"
#include "graticule/problems/pose_graph/robustify.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {
namespace {

constexpr double kFirstWindow = 2;         // m
constexpr std::size_t kSettled = 50;       // fewer than one closure in so many is new: look farther
constexpr std::size_t kLeastMeetings = 4;  // that agree, for two robots to be joined

// What must not speak against a meeting: how far to either side of the way, and seen how far, is
// compared, and the share of walls there that the other robot saw through (of simulated robots, at
// most 0.15 at true meetings, and above 0.2 at a sixth of the false ones).
constexpr double kSightWay = 8, kSightRange = 12, kSightCell = 0.2;  // m
constexpr double kMostConflict = 0.2;

class Builder {
 public:
  Builder(const LaserLog& log, const Registry& types, const FrontEndOptions& options,
          const FrontEndObserver& watch)
      : log_(log), options_(options), watch_(watch), mission_(types) {}

  FrontEndResult Build() {
    if (log_.scans.empty()) throw Error("there is no scan in this log");
    if (!options_.starts.empty() && options_.starts.size() != log_.robots.size())
      throw Error("expected the starts of all " + std::to_string(log_.robots.size()) +
                      " robots or of none, found " + std::to_string(options_.starts.size()),
                  ErrorKind::kUsage);
    Stopwatch watch;
    Follow();
    AddChain();
    mission_.report.seconds_follow = watch.Lap().wall;
    LoopSearch search(nodes_, options_);
    SetPieces({});
    Close(&search);
    Join(&search);
    mission_.report.searches = search.Searches();
    mission_.report.found = suspects_.size();
    mission_.report.rejected = suspects_.size() - believed_.size();
    mission_.report.seconds_close = watch.Lap().wall;
    Refine(&search);
    PlaceScans();
    mission_.report.seconds_refine = watch.Lap().wall;
    return std::move(mission_);
  }

 private:
  // False: look no further.
  bool Tell(const std::string& stage, double done) {
    if (watch_ && !watch_(stage, done)) is_stopped_ = true;
    return !is_stopped_;
  }

  void Follow() {
    for (std::uint32_t robot = 0; robot < log_.robots.size(); ++robot) {
      Track track = FollowScans(log_, robot, options_, [&](double done) {
        Tell("following " + log_.robots[robot], done);
      });
      first_node_.push_back(nodes_.size());
      for (TrackNode& node : track.nodes) {
        if (!options_.starts.empty()) node.pose = options_.starts[robot] * node.pose;
        nodes_.push_back(std::move(node));
      }
      if (!options_.starts.empty())
        for (PlanarPose& pose : track.scan_poses) pose = options_.starts[robot] * pose;
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
      Factor odometry =
          Between(i - 1, i, node.odometry_step,
                  Noise::Sigmas({sigmas.sigma, sigmas.sigma, sigmas.sigma_yaw}), "odometry");
      odometry.loss = {LossKind::kCauchy, 1};  // wheels slip
      graph.Add(odometry);
      graph.Add(Between(i - 1, i, node.match_step,
                        InformationNoise(MatchInformation(node, options_)), "scan"));
    }
    AddStarts();
    chain_factors_ = graph.FactorCount();
  }

  void AddStarts() {
    if (options_.starts.empty()) return;
    for (std::uint32_t robot = 1; robot < log_.robots.size(); ++robot) {
      const PlanarPose& start = options_.starts[robot];
      if (first_node_[robot] == first_node_[robot + 1]) continue;
      mission_.graph.Add(PriorSe2Factor(
          mission_.nodes[first_node_[robot]].key, {start.x, start.y, start.yaw},
          Noise::Sigmas({options_.start_sigma, options_.start_sigma, options_.start_sigma_yaw}),
          "start"));
    }
  }

  Factor Between(std::size_t a, std::size_t b, const PlanarPose& a_from_b, Noise noise,
                 const char* source) const {
    return BetweenSe2Factor(mission_.nodes[a].key, mission_.nodes[b].key,
                            {a_from_b.x, a_from_b.y, a_from_b.yaw}, std::move(noise), source);
  }

  Graph WithClosures(const std::vector<Closure>& closures) const {
    Graph with = mission_.graph;
    for (const Closure& closure : closures)
      with.Add(Between(closure.a, closure.b, closure.a_from_b,
                       InformationNoise(closure.information), "loop"));
    return with;
  }

  void TakePoses(const Values& values) {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      poses_[i] = PlanarPoseAt(values, mission_.nodes[i].key);
    mission_.graph.SetValues(values);
  }

  // Robots that closures join are one piece; of each piece, the first pose of one robot is held.
  void SetPieces(const std::vector<Closure>& closures) {
    UnionFind robots(log_.robots.size());
    for (std::uint32_t robot = 1; !options_.starts.empty() && robot < log_.robots.size(); ++robot)
      robots.Join(robot, 0);
    for (const Closure& closure : closures)
      robots.Join(nodes_[closure.a].robot, nodes_[closure.b].robot);
    std::vector<std::uint32_t>& pieces = mission_.report.piece_of_robot;
    pieces.assign(log_.robots.size(), 0);
    std::vector<std::uint8_t> is_held(log_.robots.size());
    for (std::uint32_t robot = 0; robot < pieces.size(); ++robot) {
      pieces[robot] = robots.Root(robot);
      if (first_node_[robot] == first_node_[robot + 1]) continue;
      std::uint8_t& held = is_held[pieces[robot]];
      mission_.graph.SetFixed(static_cast<VariableId>(first_node_[robot]), !held);
      held = 1;
    }
  }

  std::size_t Pieces() const {
    const std::vector<std::uint32_t>& pieces = mission_.report.piece_of_robot;
    return std::set<std::uint32_t>(pieces.begin(), pieces.end()).size();
  }

  // Solves without those of the suspects that disagree.
  void Settle(LoopSearch* search) {
    SetPieces(suspects_);
    RejectionOptions rejection;
    rejection.reject_outliers = Rejection::kGncTls;
    rejection.trusted_sources = "odometry,scan";
    const RobustSolution robust =
        SolveWithoutOutliers(WithClosures(suspects_), rejection, options_.solve);
    believed_.clear();
    for (std::size_t i = 0; i < suspects_.size(); ++i)
      if (robust.is_kept[chain_factors_ + i]) believed_.push_back(suspects_[i]);
    TakePoses(robust.solution.values);
    SetPieces(believed_);
    search->SetPieces(mission_.report.piece_of_robot);
    ++mission_.report.rounds;
  }

  // What is near first: it makes what is far better known.
  void Close(LoopSearch* search) {
    double window = std::min(kFirstWindow, options_.closure_window);
    for (int round = 0; round < options_.closure_rounds; ++round) {
      if (!Tell("closing loops", static_cast<double>(round) / options_.closure_rounds)) return;
      bool has_left = false;
      const std::vector<Closure> found = search->Search(poses_, believed_, window, &has_left);
      if (found.size() * kSettled <= suspects_.size()) {
        if (found.empty() && !has_left) break;
        window = std::min(2 * window, options_.closure_window);
      }
      if (found.empty()) continue;
      suspects_.insert(suspects_.end(), found.begin(), found.end());
      Settle(search);
    }
  }

  // What a robot saw about a node, in the node's frame.
  std::shared_ptr<const OccupancyMap> SightAt(std::uint32_t node) const {
    LiveMapOptions options;
    options.method = MapMethod::kNaive;
    options.resolution = kSightCell;
    options.ranges.max_range = kSightRange;
    LiveMap map(options);
    const PlanarPose node_from_world = Inverse(poses_[node]);
    for (std::size_t i = first_node_[nodes_[node].robot]; i < first_node_[nodes_[node].robot + 1];
         ++i) {
      if (std::abs(nodes_[i].travelled - nodes_[node].travelled) > kSightWay) continue;
      const LaserScan& scan = log_.scans[nodes_[i].scan];
      map.AddNode(0, log_.GeometryOf(scan), log_.RangesOf(scan), node_from_world * poses_[i]);
    }
    map.Update();
    return map.Map();
  }

  // Without those where one robot saw through what the other saw a wall at.
  std::vector<Closure> WithoutConflicts(const std::vector<Closure>& meetings) const {
    std::map<std::uint32_t, std::shared_ptr<const OccupancyMap>> sights;
    const auto sight = [&](std::uint32_t node) -> const OccupancyMap& {
      std::shared_ptr<const OccupancyMap>& map = sights[node];
      if (!map) map = SightAt(node);
      return *map;
    };
    std::vector<Closure> clean;
    for (const Closure& meeting : meetings) {
      const SightConflict conflict =
          ConflictOf(sight(meeting.a), sight(meeting.b), meeting.a_from_b);
      if (conflict.Share() <= kMostConflict) clean.push_back(meeting);
    }
    return clean;
  }

  // Robots whose starts nobody knows: meetings that agree with each other join them.
  void Join(LoopSearch* search) {
    while (Pieces() > 1) {
      if (!Tell("joining robots", 1 / static_cast<double>(Pieces()))) return;
      const std::vector<Closure> found = WithoutConflicts(search->Meetings(poses_));
      if (found.empty()) return;
      std::vector<Closure> all = believed_;
      all.insert(all.end(), found.begin(), found.end());
      std::vector<FactorId> ids;
      for (std::size_t i = 0; i < found.size(); ++i)
        ids.push_back(static_cast<FactorId>(chain_factors_ + believed_.size() + i));
      const ConsistencyResult consistent = FindConsistent(WithClosures(all), ids);
      std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Closure>> by_pair;
      for (std::size_t i = 0; i < found.size(); ++i)
        if (consistent.is_kept[i])
          by_pair[{nodes_[found[i].a].robot, nodes_[found[i].b].robot}].push_back(found[i]);
      const std::vector<Closure> before = suspects_;
      for (const auto& [robots, meetings] : by_pair)
        if (meetings.size() >= kLeastMeetings)
          suspects_.insert(suspects_.end(), meetings.begin(), meetings.end());
      const std::size_t pieces = Pieces();
      if (suspects_.size() == before.size()) return;
      try {
        Settle(search);
      } catch (const Error& error) {
        if (error.Kind() != ErrorKind::kIllPosed) throw;
        suspects_ = before;  // they did not agree with the rest: the robots stay apart
        SetPieces(believed_);
        return;
      }
      if (Pieces() == pieces) return;
      Close(search);
    }
  }

  void Refine(LoopSearch* search) {
    std::vector<Closure> all = believed_;
    int round = 0;
    for (; round < options_.overlap_rounds; ++round) {
      if (!Tell("refining", static_cast<double>(round) / options_.overlap_rounds)) break;
      const std::vector<Closure> overlaps = search->Overlaps(poses_);
      all.resize(believed_.size());
      all.insert(all.end(), overlaps.begin(), overlaps.end());
      mission_.report.overlaps = overlaps.size();
      TakePoses(Solve(Whole(all), options_.solve).values);
    }
    // So far solved without the losses that it is handed on with.
    if (round == 0) TakePoses(Solve(Whole(all), options_.solve).values);
    mission_.graph = Whole(all);
    mission_.world_from_node = poses_;
  }

  // With every closure and overlap; those that disagree a little still count less.
  Graph Whole(const std::vector<Closure>& closures) const {
    Graph graph = WithClosures(closures);
    for (std::size_t i = chain_factors_; i < graph.FactorCount(); ++i)
      graph.SetLoss(static_cast<FactorId>(i), {LossKind::kCauchy, 1});
    return graph;
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
          pose = Interpolated(pose, other, part);
        }
        mission_.world_from_scan[scan] = pose;
      }
    }
  }

  const LaserLog& log_;
  const FrontEndOptions& options_;
  const FrontEndObserver& watch_;
  FrontEndResult mission_;
  std::vector<TrackNode> nodes_;
  std::vector<std::size_t> first_node_;  // of each robot, and the end
  std::vector<Track> tracks_;            // without their nodes
  std::vector<PlanarPose> poses_;        // of nodes, as of the last solution
  std::vector<Closure> suspects_, believed_;
  std::size_t chain_factors_ = 0;
  bool is_stopped_ = false;
};

}  // namespace

FrontEndResult BuildMission(const LaserLog& log, const Registry& types,
                            const FrontEndOptions& options, const FrontEndObserver& watch) {
  return Builder(log, types, options, watch).Build();
}

}  // namespace graticule
