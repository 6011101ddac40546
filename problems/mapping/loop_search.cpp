#include "graticule/problems/mapping/loop_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "graticule/problems/mapping/likely_turns.hpp"
#include "graticule/problems/mapping/point_refine.hpp"
#include "graticule/problems/mapping/pose_noise.hpp"
#include "graticule/problems/mapping/scan_match.hpp"
#include "graticule/problems/parallel_for.hpp"

namespace graticule {
namespace {

constexpr double kPlaceDistance = 1.5;    // m of the way, from one place to the next
constexpr double kLeastWay = 6;           // m of the way between the two ends of a closure
constexpr std::uint32_t kPiece = 6;       // places of a pass of which only the nearest is tried
constexpr std::size_t kMostPerPlace = 4;  // candidates of a place in a round
constexpr double kReferenceReach = 4, kQueryReach = 2;  // m of the way to each side
constexpr double kCell = 0.05, kBlur = 0.07;            // m
constexpr std::size_t kSearchPoints = 400, kRefinePoints = 1500;
// Wider windows are searched on coarser grids first, and then about what was found.
constexpr double kAnyYaw = 1, kWide = 0.8;          // rad, m: what is wider
constexpr double kAround = 0.2, kAroundYaw = 0.03;  // m, rad: times the level
// Robots that may be anywhere: every so many places, and how much better than near ones.
constexpr std::size_t kMeetingStride = 4, kMostMeetings = 6000;
constexpr double kMeetingReach = 5, kMeetingScore = 0.1;  // m
constexpr double kLeastMatched = 0.5;
constexpr double kPointSigma = 0.04;  // m: of a point, as if points were independent
constexpr double kLostMatched = 0.6, kLostSigmas = 100;
constexpr double kStretchScans = 10;  // scans of a stretch say the same: count as one
constexpr double kOverlapDistance = 2.5, kOverlapWay = 5, kOverlapReach = 2;  // m
constexpr double kOverlapShift = 0.3, kOverlapTurn = 0.1;                     // m, rad

std::size_t ThreadsOf(const FrontEndOptions& options) {
  if (options.threads > 0) return static_cast<std::size_t>(options.threads);
  return std::max(std::thread::hardware_concurrency(), 1u);
}

double Distance(const PlanarPose& a, const PlanarPose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

std::vector<SurfacePoint> Thinned(const std::vector<SurfacePoint>& points, std::size_t most) {
  std::vector<SurfacePoint> thinned;
  const std::size_t count = std::min(points.size(), most);
  for (std::size_t i = 0; i < count; ++i) thinned.push_back(points[i * points.size() / count]);
  return thinned;
}

}  // namespace

struct LoopSearch::Worker {
  LikelihoodGrid grids[3] = {{kCell, kBlur}, {2 * kCell, 2 * kBlur}, {4 * kCell, 3 * kBlur}};
  CorrelativeMatcher matcher;
  PointIndex index;
  std::vector<SurfacePoint> reference, query;
  // What reference, and the grids of these levels, are of: many are looked for in one.
  std::uint32_t reference_of = UINT32_MAX;
  bool is_built[3] = {};
  bool is_indexed = false;
};

Eigen::Matrix3d MatchInformation(const TrackNode& node, const FrontEndOptions& options) {
  // Where too little was matched, the way may be lost.
  const double lost = std::max(1.0, kLostSigmas * (1 - node.matched / kLostMatched));
  return WithFloor(node.information / (kPointSigma * kPointSigma), options.drift_sigma * lost,
                   options.drift_sigma_yaw * lost);
}

Eigen::Matrix3d ChainInformation(const TrackNode& node, const FrontEndOptions& options) {
  const MotionSigmas sigmas = SigmasOf(node.odometry_step, options);
  Eigen::Matrix3d information = MatchInformation(node, options);
  information.diagonal() += Eigen::Vector3d(std::pow(sigmas.sigma, -2), std::pow(sigmas.sigma, -2),
                                            std::pow(sigmas.sigma_yaw, -2));
  return information;
}

LoopSearch::LoopSearch(const std::vector<TrackNode>& nodes, const FrontEndOptions& options)
    : nodes_(nodes), options_(options), threads_(ThreadsOf(options)) {
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].is_first || nodes[i].travelled >= nodes[places_.back()].travelled + kPlaceDistance)
      places_.push_back(i);
    place_of_.push_back(static_cast<std::uint32_t>(places_.size() - 1));
    pieces_.resize(nodes[i].robot + 1, options.starts.empty() ? nodes[i].robot : 0);
  }
}

void LoopSearch::Stretch(std::uint32_t node, double reach, const std::vector<PlanarPose>& poses,
                         std::vector<SurfacePoint>* points) const {
  const auto is_near = [&](std::uint32_t i) {
    return nodes_[i].robot == nodes_[node].robot &&
           std::abs(nodes_[i].travelled - nodes_[node].travelled) <= reach;
  };
  points->clear();
  std::uint32_t first = node, last = node;
  while (first > 0 && is_near(first - 1)) --first;
  while (last + 1 < nodes_.size() && is_near(last + 1)) ++last;
  const PlanarPose node_from_world = Inverse(poses[node]);
  for (std::uint32_t i = first; i <= last; ++i)
    AppendTransformed(nodes_[i].points, node_from_world * poses[i], points);
}

std::vector<UncertainEdge> LoopSearch::PlaceEdges(const std::vector<Closure>& believed) const {
  std::vector<UncertainEdge> edges;
  Eigen::Matrix3d since = Eigen::Matrix3d::Zero();  // the last place
  for (std::uint32_t i = 1; i < nodes_.size(); ++i) {
    if (nodes_[i].is_first) {
      since.setZero();
      continue;
    }
    const Eigen::Matrix3d carry = Adjoint(Inverse(nodes_[i].match_step));
    since = carry * since * carry.transpose() + ChainInformation(nodes_[i], options_).inverse();
    if (places_[place_of_[i]] != i) continue;
    edges.push_back({place_of_[i] - 1, place_of_[i], since});
    since.setZero();
  }
  for (const Closure& closure : believed) {
    Eigen::Matrix3d information = closure.information;
    information.diagonal() += Eigen::Vector3d::Constant(1e-2);
    edges.push_back({place_of_[closure.a], place_of_[closure.b], information.inverse()});
  }
  if (options_.starts.empty()) return edges;
  for (std::uint32_t i = 1; i < nodes_.size(); ++i) {
    if (!nodes_[i].is_first) continue;
    const double m = options_.start_sigma, rad = options_.start_sigma_yaw;
    edges.push_back({0, place_of_[i], Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal()});
  }
  return edges;
}

std::vector<LoopSearch::Candidate> LoopSearch::Candidates(const std::vector<PlanarPose>& poses,
                                                          const std::vector<Closure>& believed,
                                                          double window, bool* has_left) const {
  std::vector<PlanarPose> place_poses;
  for (const std::uint32_t node : places_) place_poses.push_back(poses[node]);

  std::vector<std::vector<Candidate>> found(places_.size());
  std::vector<RelativeUncertainty> uncertainty(
      threads_, RelativeUncertainty(places_.size(), PlaceEdges(believed)));
  std::atomic<bool> is_left{false};
  ParallelFor(places_.size(), threads_, [&](std::size_t worker, std::size_t b) {
    const auto to = static_cast<std::uint32_t>(b);
    RelativeUncertainty& known = uncertainty[worker];
    known.From(to, place_poses);
    std::vector<Candidate>& own = found[b];
    double nearest = 0;
    std::uint32_t piece_begin = 0;
    for (std::uint32_t a = 0; a < to; ++a) {
      const TrackNode& node_a = nodes_[places_[a]];
      const TrackNode& node_b = nodes_[places_[b]];
      if (!known.IsReached(a)) continue;
      if (node_a.robot == node_b.robot && node_b.travelled - node_a.travelled < kLeastWay) continue;
      const Eigen::Matrix3d& covariance = known.Of(a);
      const double spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(
                                covariance.topLeftCorner<2, 2>(), Eigen::EigenvaluesOnly)
                                .eigenvalues()[1];
      const double sigma = std::sqrt(spread);
      const double distance = Distance(place_poses[a], place_poses[b]);
      if (distance - 2 * sigma > options_.closure_reach) continue;
      const double reach = 3 * sigma + 0.3;
      if (reach > window && window < options_.closure_window) {
        is_left = true;
        continue;
      }
      // Looking far is dear, and one thing found far off lets the rest be looked for nearby.
      const double wide = std::min(reach, window);
      const auto stride = static_cast<std::uint32_t>(std::clamp(wide / 3, 1.0, 6.0));
      if (to % stride != 0) continue;
      const auto piece = std::max(kPiece, static_cast<std::uint32_t>(wide / kPlaceDistance));
      Candidate candidate;
      candidate.a = a;
      candidate.b = to;
      candidate.reach = std::clamp(reach, 0.5, window);
      candidate.reach_yaw = std::clamp(3 * std::sqrt(covariance(2, 2)) + 0.05, 0.1, M_PI);
      candidate.cost = distance + sigma;
      const bool same_piece = !own.empty() && a < piece_begin + piece && own.back().a + 3 > a;
      if (!same_piece) {
        own.push_back(candidate);
        piece_begin = a;
        nearest = distance;
      } else if (distance < nearest) {
        own.back() = candidate;
        nearest = distance;
      }
    }
    std::sort(own.begin(), own.end(), [](const Candidate& x, const Candidate& y) {
      return x.cost != y.cost ? x.cost < y.cost : x.a < y.a;
    });
    if (own.size() > kMostPerPlace) own.resize(kMostPerPlace);
  });
  *has_left = is_left;
  std::vector<Candidate> all;
  for (const std::vector<Candidate>& own : found)
    for (const Candidate& candidate : own) {
      const auto before = tried_.find({candidate.a, candidate.b});
      if (before != tried_.end()) {
        const PlanarPose guess = Inverse(place_poses[candidate.a]) * place_poses[candidate.b];
        const PlanarPose moved = Inverse(before->second.guess) * guess;
        if (std::hypot(moved.x, moved.y) < std::max(0.3, before->second.reach / 2) &&
            std::abs(moved.yaw) < 0.1)
          continue;
      }
      all.push_back(candidate);
    }
  return all;
}

// The best of the turns at which surfaces face the same ways.
bool LoopSearch::SearchAllRound(const LikelihoodGrid& grid, const std::vector<SurfacePoint>& points,
                                const Trial& trial, Worker* worker, Match* best) const {
  bool is_found = false;
  double least = trial.least_score;
  for (const TurnRange& turns : LikelyTurns(worker->reference, worker->query)) {
    SearchWindow window = trial.window;
    window.guess.yaw = turns.centre;
    window.reach_yaw = turns.half;
    Match match;
    if (!worker->matcher.Search(grid, points, window, least, &match)) continue;
    *best = match;
    least = match.score;
    is_found = true;
  }
  return is_found;
}

bool LoopSearch::Try(const Trial& trial, const std::vector<PlanarPose>& poses, Worker* worker,
                     Closure* closure) const {
  if (worker->reference_of != trial.a) {
    Stretch(trial.a, kReferenceReach, poses, &worker->reference);
    worker->reference_of = trial.a;
    std::fill(std::begin(worker->is_built), std::end(worker->is_built), false);
    worker->is_indexed = false;
  }
  Stretch(trial.b, kQueryReach, poses, &worker->query);
  SearchWindow window = trial.window;
  Match match;
  for (int level = window.reach_yaw > kAnyYaw ? 2
                   : window.reach > kWide     ? 1
                                              : 0;
       level >= 0; --level) {
    LikelihoodGrid& grid = worker->grids[level];
    if (!worker->is_built[level]) grid.Build(worker->reference, 0, 0, options_.max_range);
    worker->is_built[level] = true;
    const std::vector<SurfacePoint> points = Thinned(worker->query, kSearchPoints >> level);
    const bool any_yaw = window.reach_yaw >= M_PI;
    const bool is_found =
        any_yaw ? SearchAllRound(grid, points, trial, worker, &match)
                : worker->matcher.Search(grid, points, window, trial.least_score, &match);
    if (!is_found) return false;
    window = SearchWindow();
    window.guess = match.reference_from_scan;
    window.reach = kAround * level;
    window.reach_yaw = kAroundYaw * level;
  }
  if (!worker->is_indexed) worker->index.Build(worker->reference);
  worker->is_indexed = true;
  RefineOptions refine;
  refine.scale = 0.05;
  const Refinement refined = RefineOnPoints(
      worker->index, Thinned(worker->query, kRefinePoints), match.reference_from_scan,
      match.reference_from_scan, Eigen::Vector3d(10, 10, 100).asDiagonal(), 0.03, refine);
  if (refined.matched < kLeastMatched) return false;
  closure->a = trial.a;
  closure->b = trial.b;
  closure->a_from_b = refined.reference_from_scan;
  closure->information =
      WithFloor(refined.information / (kPointSigma * kPointSigma * kStretchScans),
                options_.closure_sigma, options_.closure_sigma_yaw);
  closure->score = match.score;
  closure->matched = refined.matched;
  return true;
}

std::vector<Closure> LoopSearch::Search(const std::vector<PlanarPose>& poses,
                                        const std::vector<Closure>& believed, double window,
                                        bool* has_left) {
  const std::vector<Candidate> candidates = Candidates(poses, believed, window, has_left);
  std::vector<Trial> trials;
  for (const Candidate& candidate : candidates) {
    Trial trial;
    trial.a = places_[candidate.a];
    trial.b = places_[candidate.b];
    trial.window.guess = Inverse(poses[trial.a]) * poses[trial.b];
    trial.window.reach = candidate.reach;
    trial.window.reach_yaw = candidate.reach_yaw;
    trial.least_score = options_.closure_score;
    tried_[{candidate.a, candidate.b}] = {trial.window.guess, candidate.reach};
    trials.push_back(trial);
  }
  return TryAll(trials, poses);
}

std::vector<Closure> LoopSearch::TryAll(const std::vector<Trial>& trials,
                                        const std::vector<PlanarPose>& poses) {
  searches_ += trials.size();
  std::vector<Worker> workers(threads_);
  std::vector<Closure> found(trials.size());
  std::vector<std::uint8_t> is_found(trials.size());
  ParallelFor(trials.size(), threads_, [&](std::size_t worker, std::size_t i) {
    is_found[i] = Try(trials[i], poses, &workers[worker], &found[i]);
  });
  std::vector<Closure> closures;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (is_found[i]) closures.push_back(found[i]);
  return closures;
}

std::vector<Closure> LoopSearch::Meetings(const std::vector<PlanarPose>& poses) {
  std::vector<Trial> trials;
  for (std::size_t b = 0; b < places_.size(); b += kMeetingStride)
    for (std::size_t a = 0; a < b; a += kMeetingStride) {
      Trial trial;
      trial.a = places_[a];
      trial.b = places_[b];
      if (pieces_[nodes_[trial.a].robot] == pieces_[nodes_[trial.b].robot]) continue;
      trial.window.reach = kMeetingReach;
      trial.window.reach_yaw = M_PI;
      trial.least_score = std::min(options_.closure_score + kMeetingScore, 0.9);
      trials.push_back(trial);
    }
  if (trials.size() > kMostMeetings) {
    for (std::size_t i = 0; i < kMostMeetings; ++i)
      trials[i] = trials[i * trials.size() / kMostMeetings];
    trials.resize(kMostMeetings);
  }
  std::stable_sort(trials.begin(), trials.end(), [](const Trial& x, const Trial& y) {
    return x.a < y.a;  // one reference for many
  });
  // A stretch has many that are like it, and one that is most like it.
  std::map<std::pair<std::uint32_t, std::uint32_t>, Closure> best;  // by node b and piece of a
  for (const Closure& closure : TryAll(trials, poses)) {
    Closure& other = best[{closure.b, pieces_[nodes_[closure.a].robot]}];
    if (closure.score > other.score) other = closure;
  }
  std::vector<Closure> closures;
  for (const auto& [key, closure] : best) closures.push_back(closure);
  return closures;
}

std::vector<Closure> LoopSearch::Overlaps(const std::vector<PlanarPose>& poses) {
  std::vector<Worker> workers(threads_);
  std::vector<std::vector<Closure>> found(places_.size());
  ParallelFor(places_.size(), threads_, [&](std::size_t worker, std::size_t place) {
    const std::uint32_t a = places_[place];
    Worker& own = workers[worker];
    bool is_built = false;
    for (std::uint32_t b = 0; b < nodes_.size(); ++b) {
      if (Distance(poses[a], poses[b]) > kOverlapDistance) continue;
      if (nodes_[a].robot == nodes_[b].robot &&
          nodes_[b].travelled - nodes_[a].travelled < kOverlapWay)
        continue;
      if (nodes_[a].robot != nodes_[b].robot &&
          (b < a || pieces_[nodes_[a].robot] != pieces_[nodes_[b].robot]))
        continue;
      // Of the places of this pass, the nearest.
      const double distance = Distance(poses[a], poses[b]);
      bool is_nearest = true;
      for (std::size_t other = place > 2 ? place - 2 : 0;
           other <= place + 2 && other < places_.size(); ++other)
        is_nearest &= nodes_[places_[other]].robot != nodes_[a].robot || other == place ||
                      Distance(poses[places_[other]], poses[b]) >= distance;
      if (!is_nearest) continue;
      if (!is_built) {
        Stretch(a, kOverlapReach, poses, &own.reference);
        own.index.Build(own.reference);
        is_built = true;
      }
      const PlanarPose guess = Inverse(poses[a]) * poses[b];
      RefineOptions refine;
      refine.scale = 0.05;
      const Refinement refined =
          RefineOnPoints(own.index, nodes_[b].points, guess, guess,
                         Eigen::Vector3d(100, 100, 400).asDiagonal(), 0.03, refine);
      const PlanarPose shift = Inverse(guess) * refined.reference_from_scan;
      if (refined.matched < kLeastMatched || std::hypot(shift.x, shift.y) > kOverlapShift ||
          std::abs(shift.yaw) > kOverlapTurn)
        continue;
      Closure closure;
      closure.a = a;
      closure.b = b;
      closure.a_from_b = refined.reference_from_scan;
      closure.information = WithFloor(refined.information / (kPointSigma * kPointSigma),
                                      options_.closure_sigma / 2, options_.closure_sigma_yaw / 2);
      closure.matched = refined.matched;
      found[place].push_back(closure);
    }
  });
  std::vector<Closure> all;
  for (const std::vector<Closure>& own : found) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace graticule
