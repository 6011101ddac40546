#include "graticule/problems/mapping/live_map.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <string>

#include "graticule/problems/mapping/cover.hpp"
#include "graticule/problems/mapping/cover_slices.hpp"
#include "graticule/problems/mapping/map_extent.hpp"
#include "graticule/problems/mapping/planar_values.hpp"
#include "graticule/problems/mapping/projection_error.hpp"
#include "graticule/problems/mapping/rasteriser.hpp"
#include "graticule/problems/mapping/scan_points.hpp"
#include "graticule/problems/mapping/votes.hpp"
#include "graticule/problems/mapping/work_estimate.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);
constexpr std::size_t kMaxVotes = (std::size_t{1} << kVotePlanes) - 1;
// Below so many nodes a thread costs more than it brings (it takes some 30 us to begin and end).
constexpr std::size_t kNodesWorthAThread = 24;

}  // namespace

class LiveMap::Machine {
 public:
  explicit Machine(const LiveMapOptions& options)
      : options_(options),
        reader_(options.ranges),
        slices_(options.slice_size),
        extent_(options.resolution),
        grid_(options.votes),
        map_(std::make_shared<const OccupancyMap>(options.resolution)) {
    for (int i = 0; i < options.threads; ++i) rasterisers_.emplace_back(options.resolution);
  }

  NodeId AddNode(std::uint32_t robot, const LaserGeometry& geometry, Span<const float> ranges,
                 const PlanarPose& pose) {
    if (ranges.empty()) throw Error("a scan of robot " + std::to_string(robot) + " has no beams");
    if (nodes_.size() >= kMaxVotes)
      throw Error("a live map holds at most " + std::to_string(kMaxVotes) + " nodes");
    Node node;
    node.robot = robot;
    node.points = reader_.Read(geometry, ranges);
    Place place;
    place.pose = pose;
    place.reach = node.points.reach;
    extent_.Include(nodes_.size(), pose, place.reach);
    nodes_.push_back(std::move(node));
    places_.push_back(place);
    return static_cast<NodeId>(nodes_.size() - 1);
  }

  void UpdatePose(NodeId id, const PlanarPose& pose) {
    if (id >= nodes_.size())
      throw Error("expected a node below " + std::to_string(nodes_.size()) + ", found " +
                  std::to_string(id));
    extent_.Include(id, pose, places_[id].reach);
    Move(id, pose);
  }

  void UpdatePoses(Span<const PlanarPose> poses) {
    if (poses.size() != nodes_.size())
      throw Error("expected a pose for each of " + std::to_string(nodes_.size()) +
                  " nodes, found " + std::to_string(poses.size()));
    MapExtent extent = extent_;
    for (NodeId id = 0; id < poses.size(); ++id) extent.Include(id, poses[id], places_[id].reach);
    extent_ = extent;
    for (NodeId id = 0; id < poses.size(); ++id) Move(id, poses[id]);
  }

  MapUpdate UpdateExactly() {
    limit_ = 0;
    for (std::size_t slice = 0; slice < slices_.Count(); ++slice) slices_.Watch(slice);
    MapUpdate update = Update(std::numeric_limits<double>::infinity());
    limit_ = options_.regenerate_above * options_.resolution;
    return update;
  }

  MapUpdate Update(double deadline) {
    started_ = Clock::now();
    progress_ = false;
    deadline_ = options_.method == MapMethod::kIncremental
                    ? deadline
                    : std::numeric_limits<double>::infinity();
    MapUpdate update;
    switch (options_.method) {
      case MapMethod::kNaive:
        for (; next_ < nodes_.size(); ++next_) JoinCover(next_);
        DrawAll();
        break;
      case MapMethod::kNaiveCover:
        DrawAll();
        TakeNewNodes();
        break;
      case MapMethod::kCoverComposite:
        RegenerateStale(&update);
        TakeNewNodes();
        Composite();
        break;
      case MapMethod::kIncremental:
        RegenerateStale(&update);
        TakeNewNodes();
        break;
    }
    for (NodeId id = next_; id < nodes_.size(); ++id) update.waiting.push_back(id);
    Publish(&update);
    update.nodes = nodes_.size();
    update.cover = slices_.Nodes().size();
    update.slices = slices_.Count();
    update.seconds = Elapsed();
    return update;
  }

  std::shared_ptr<const OccupancyMap> Map() const {
    const std::lock_guard<std::mutex> lock(map_mutex_);
    return map_;
  }
  std::size_t NodeCount() const { return nodes_.size(); }
  const std::vector<NodeId>& Cover() const { return slices_.Nodes(); }
  const PlanarPose& DrawnPose(NodeId id) const {
    if (id >= nodes_.size() || places_[id].slice == kNone)
      throw Error("node " + std::to_string(id) + " is not in the cover");
    return places_[id].drawn_at;
  }

 private:
  // What every new pose is looked up in; kept apart from what only drawing needs.
  struct Place {
    PlanarPose pose, drawn_at;
    double reach = 0;
    std::size_t slice = kNone;
  };
  struct Node {
    std::uint32_t robot = 0;
    ScanPoints points;
    std::vector<ScanTile> drawing;  // of the cover only
  };
  using Clock = std::chrono::steady_clock;

  double Elapsed() const { return std::chrono::duration<double>(Clock::now() - started_).count(); }

  void Move(NodeId id, const PlanarPose& pose) {
    Place& place = places_[id];
    place.pose = pose;
    if (place.slice == kNone || slices_[place.slice].watched) return;
    if (ProjectionErrorBound(limit_, place.reach, place.drawn_at, pose) == Bound::kWithin) return;
    slices_.Watch(place.slice);
  }

  // Algorithm 2.1, lines 9 to 13.
  void RegenerateStale(MapUpdate* update) {
    std::vector<std::size_t> stale;
    for (const std::size_t slice : slices_.TakeWatched()) {
      if (IsStale(slices_[slice]))
        stale.push_back(slice);
      else
        slices_[slice].waited = false;
    }
    // What has waited longest comes first, then what came first.
    std::sort(stale.begin(), stale.end(), [this](std::size_t a, std::size_t b) {
      return slices_[a].waited != slices_[b].waited ? slices_[a].waited : a < b;
    });
    std::size_t done = 0;
    while (done < stale.size()) {
      const std::size_t end = NextBatch(stale, done);
      if (end == done) break;
      Regenerate(stale.data() + done, stale.data() + end, update);
      done = end;
    }
    for (; done < stale.size(); ++done) {
      CoverSlice& slice = slices_[stale[done]];
      slice.waited = true;
      slices_.Watch(stale[done]);
      update->left_over.push_back({stale[done], slice.robot, slice.nodes.front(),
                                   slice.nodes.back(), ErrorOf(slice) / options_.resolution});
    }
  }

  bool IsStale(const CoverSlice& slice) const {
    for (const NodeId id : slice.nodes)
      if (ProjectionErrorExceeds(limit_, nodes_[id].points, places_[id].drawn_at, places_[id].pose))
        return true;
    return false;
  }

  double ErrorOf(const CoverSlice& slice) const {
    double error = 0;
    for (const NodeId id : slice.nodes)
      error = std::max(
          error, ProjectionErrorAtMost(places_[id].reach, places_[id].drawn_at, places_[id].pose));
    return error;
  }

  // The end of the slices from `begin` that there is time for, and that are drawn at once.
  std::size_t NextBatch(const std::vector<std::size_t>& stale, std::size_t begin) const {
    const std::size_t batch =
        options_.threads > 1 ? kNodesWorthAThread * static_cast<std::size_t>(options_.threads) : 1;
    // New nodes show what nobody has seen: time is kept for them.
    const std::size_t reserved = nodes_.size() - next_;
    std::size_t drawn = 0, end = begin;
    for (; end < stale.size() && drawn < batch; ++end) {
      const std::size_t nodes = slices_[stale[end]].nodes.size();
      // A deadline that nothing fits in must not hold the map up for ever.
      const bool first = !progress_ && drawn == 0;
      const std::size_t left = (stale.size() - end) * options_.slice_size;
      if (!first &&
          !work_.Fits(Elapsed(), deadline_, drawn + nodes, reserved, left, grid_.DirtyTiles()))
        break;
      drawn += nodes;
    }
    return end;
  }

  void Regenerate(const std::size_t* begin, const std::size_t* end, MapUpdate* update) {
    const double started = Elapsed();
    batch_.clear();
    for (const std::size_t* slice = begin; slice < end; ++slice)
      for (const NodeId id : slices_[*slice].nodes) batch_.push_back(id);
    const std::size_t dirty = grid_.DirtyTiles();
    DrawBatch();
    for (const std::size_t* slice = begin; slice < end; ++slice) {
      slices_[*slice].waited = false;
      if (options_.method == MapMethod::kCoverComposite) DrawDense(&slices_[*slice]);
    }
    progress_ = true;
    update->regenerated_slices += static_cast<std::size_t>(end - begin);
    update->regenerated_nodes += batch_.size();
    work_.Drew(batch_.size(), Elapsed() - started, grid_.DirtyTiles() - dirty);
  }

  // Draws the nodes of batch_ where they are now, and puts them into the map instead of what was
  // drawn before.
  void DrawBatch() {
    fresh_.resize(std::max(fresh_.size(), batch_.size()));
    const std::size_t threads =
        std::clamp<std::size_t>(batch_.size() / kNodesWorthAThread, 1, rasterisers_.size());
    for (const NodeId id : batch_) Expect(nodes_[id]);
    ParallelFor(batch_.size(), threads, [this](std::size_t worker, std::size_t i) {
      rasterisers_[worker].Draw(nodes_[batch_[i]].points, places_[batch_[i]].pose, &fresh_[i]);
    });
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      Node& node = nodes_[batch_[i]];
      Replace(node.robot, node.drawing, fresh_[i]);
      node.drawing.swap(fresh_[i]);
      places_[batch_[i]].drawn_at = places_[batch_[i]].pose;
    }
  }

  // Algorithm 2.1, lines 1 to 8.
  void TakeNewNodes() {
    for (; next_ < nodes_.size(); ++next_) {
      const double started = Elapsed();
      if (progress_ && !work_.FitsNew(started, deadline_, grid_.DirtyTiles())) break;
      progress_ = true;
      const std::size_t dirty = grid_.DirtyTiles();
      Node& node = nodes_[next_];
      rasterisers_[0].Draw(node.points, places_[next_].pose, &candidate_);
      if (!options_.cover.on || SightOf(node.robot).Adds(candidate_, options_.cover)) {
        node.drawing = candidate_;
        places_[next_].drawn_at = places_[next_].pose;
        JoinCover(next_);
        if (options_.method == MapMethod::kCoverComposite)
          DrawDense(&slices_[places_[next_].slice]);
        Replace(node.robot, {}, node.drawing);
      }
      work_.Took(Elapsed() - started, grid_.DirtyTiles() - dirty);
    }
  }

  // What the cover that a robot's nodes may join has seen.
  CoverSight& SightOf(std::uint32_t robot) {
    return options_.cover.across_robots ? sight_ : sights_[robot];
  }

  void JoinCover(NodeId id) {
    const Node& node = nodes_[id];
    places_[id].slice = slices_.Join(node.robot, id);
  }

  void DrawDense(CoverSlice* slice) {
    std::vector<const std::vector<ScanTile>*> drawings;
    for (const NodeId id : slice->nodes) drawings.push_back(&nodes_[id].drawing);
    slice->dense.Draw(drawings);
  }

  // Lines 14 to 17.
  void Composite() {
    grid_.Clear();
    for (std::size_t i = 0; i < slices_.Count(); ++i) slices_[i].dense.CompositeOnto(&grid_);
  }

  void DrawAll() {
    grid_.Clear();
    for (const NodeId id : slices_.Nodes()) {
      Node& node = nodes_[id];
      rasterisers_[0].Draw(node.points, places_[id].pose, &candidate_);
      places_[id].drawn_at = places_[id].pose;
      for (const ScanTile& tile : candidate_) grid_.Replace({tile.index, {}, {}}, tile);
      if (options_.method == MapMethod::kNaive || !options_.cover.on) continue;
      CoverSight& sight = SightOf(node.robot);
      ForEachDifference(node.drawing, candidate_,
                        [&sight](const ScanTile& a, const ScanTile& b) { sight.Replace(a, b); });
      node.drawing.swap(candidate_);
    }
  }

  // What is drawn of a node will be replaced.
  void Expect(const Node& node) {
    const CoverSight* sight = options_.cover.on ? &SightOf(node.robot) : nullptr;
    for (const ScanTile& tile : node.drawing) {
      grid_.Expect(tile.index);
      if (sight) sight->Expect(tile.index);
    }
  }

  // What a node of the cover has drawn, in the map and in what the cover has seen.
  void Replace(std::uint32_t robot, const std::vector<ScanTile>& before,
               const std::vector<ScanTile>& after) {
    const bool votes = options_.method != MapMethod::kCoverComposite;
    CoverSight* sight = options_.cover.on ? &SightOf(robot) : nullptr;
    ForEachDifference(before, after, [&](const ScanTile& a, const ScanTile& b) {
      if (votes) grid_.Replace(a, b);
      if (sight) sight->Replace(a, b);
    });
  }

  void Publish(MapUpdate* update) {
    const double started = Elapsed();
    const auto next = grid_.Publish(map_, &update->change);
    update->version = next->Version();
    work_.Published(Elapsed() - started, update->change.dirty_tiles);
    const std::lock_guard<std::mutex> lock(map_mutex_);
    map_ = next;
  }

  LiveMapOptions options_;
  ScanReader reader_;
  std::vector<Node> nodes_;
  std::vector<Place> places_;                   // a node
  NodeId next_ = 0;                             // the first that Update has not looked at
  std::map<std::uint32_t, CoverSight> sights_;  // by robot
  CoverSight sight_;                            // of all robots' covers, for across_robots
  CoverSlices slices_;
  MapExtent extent_;
  VoteGrid grid_;
  std::vector<Rasteriser> rasterisers_;  // a thread
  std::vector<ScanTile> candidate_;
  std::vector<NodeId> batch_;
  std::vector<std::vector<ScanTile>> fresh_;
  Clock::time_point started_;  // this update
  double deadline_ = 0;
  double limit_ = options_.regenerate_above * options_.resolution;  // m, that a slice may be off
  bool progress_ = false;  // this update has drawn something
  WorkEstimate work_;
  mutable std::mutex map_mutex_;  // held for the copy of a pointer only
  std::shared_ptr<const OccupancyMap> map_;
};

LiveMap::LiveMap(const LiveMapOptions& options) {
  CheckLiveMapOptions(options);
  machine_ = std::make_unique<Machine>(options);
}
LiveMap::~LiveMap() = default;

NodeId LiveMap::AddNode(std::uint32_t robot, const LaserGeometry& geometry,
                        Span<const float> ranges, const PlanarPose& world_from_robot) {
  return machine_->AddNode(robot, geometry, ranges, world_from_robot);
}
void LiveMap::UpdatePose(NodeId node, const PlanarPose& world_from_robot) {
  machine_->UpdatePose(node, world_from_robot);
}
void LiveMap::UpdatePoses(Span<const PlanarPose> world_from_robot) {
  machine_->UpdatePoses(world_from_robot);
}
void LiveMap::UpdatePoses(const Values& values, const std::vector<Key>& keys) {
  std::vector<PlanarPose> poses;
  poses.reserve(keys.size());
  for (const Key& key : keys) poses.push_back(PlanarPoseAt(values, key));
  machine_->UpdatePoses(poses);
}
MapUpdate LiveMap::Update(double deadline) { return machine_->Update(deadline); }
MapUpdate LiveMap::UpdateExactly() { return machine_->UpdateExactly(); }
std::shared_ptr<const OccupancyMap> LiveMap::Map() const { return machine_->Map(); }
std::size_t LiveMap::NodeCount() const { return machine_->NodeCount(); }
const std::vector<NodeId>& LiveMap::Cover() const { return machine_->Cover(); }
const PlanarPose& LiveMap::DrawnPose(NodeId node) const { return machine_->DrawnPose(node); }

}  // namespace graticule
