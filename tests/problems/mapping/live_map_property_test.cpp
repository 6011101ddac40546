// The incremental map against one made from scratch, over random sequences of graphs.

#include <gtest/gtest.h>

#include <map>

#include "room.hpp"

namespace graticule {
namespace {

struct Case {
  unsigned seed;
  std::size_t slice_size;
  bool cover;
  int threads;
  double threshold;
  VoteRule votes;
};

void PrintTo(const Case& test_case, std::ostream* out) { *out << "seed " << test_case.seed; }

// What the change set says, replayed on a map of one's own, as a planner would.
class Follower {
 public:
  void Follow(const MapUpdate& update, const OccupancyMap& map) {
    for (const CellFlip& flip : update.change.flips) {
      EXPECT_EQ((labels_[{flip.cell.x, flip.cell.y}]), flip.from);
      EXPECT_NE(flip.from, flip.to);
      labels_[{flip.cell.x, flip.cell.y}] = flip.to;
    }
    for (const CellIndex& cell : update.change.frontier_came)
      EXPECT_TRUE(frontier_.emplace(std::make_pair(cell.x, cell.y), true).second);
    for (const CellIndex& cell : update.change.frontier_went)
      EXPECT_EQ(frontier_.erase({cell.x, cell.y}), 1u);
    EXPECT_EQ(update.version, map.Version());
    std::size_t known = 0, frontier = 0;
    const CellBox box = map.KnownBox();
    for (int y = box.bottom; y < box.bottom + box.height; ++y)
      for (int x = box.left; x < box.left + box.width; ++x) {
        const Occupancy label = map.At(x, y);
        known += label != Occupancy::kUnknown;
        EXPECT_EQ((labels_[{x, y}]), label);
        bool beside_unknown = false;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
          beside_unknown |= map.At(x + dx, y + dy) == Occupancy::kUnknown;
        EXPECT_EQ(map.IsFrontier(x, y), label == Occupancy::kFree && beside_unknown);
        frontier += map.IsFrontier(x, y);
      }
    std::size_t followed = 0;
    for (const auto& [cell, label] : labels_) followed += label != Occupancy::kUnknown;
    EXPECT_EQ(followed, known);
    EXPECT_EQ(frontier_.size(), frontier);
  }

 private:
  std::map<std::pair<int, int>, Occupancy> labels_;
  std::map<std::pair<int, int>, bool> frontier_;
};

class LiveMapProperty : public ::testing::TestWithParam<Case> {};

TEST_P(LiveMapProperty, EqualsAFreshCompositeOfTheSamePosesAlways) {
  const Case& parameters = GetParam();
  LiveMapOptions options;
  options.slice_size = parameters.slice_size;
  options.cover.on = parameters.cover;
  options.threads = parameters.threads;
  options.regenerate_above = parameters.threshold;
  options.votes = parameters.votes;
  LiveMap incremental(options);
  options.method = MapMethod::kCoverComposite;
  LiveMap composite(options);
  options.method = MapMethod::kIncremental;

  test::Team team(parameters.seed);
  std::vector<test::Node> nodes;
  std::vector<PlanarPose> poses;
  Follower follower;
  for (int graph = 0; graph < 25; ++graph) {
    for (int i = static_cast<int>(team.Uniform(0, 6)); i > 0; --i) {
      const int beams = team.Uniform(0, 1) < 0.5 ? 180 : 361;
      const LaserGeometry laser = test::Laser(beams, beams == 180 ? test::kPi : 4.5);
      const PlanarPose pose = team.Place();
      const auto robot = static_cast<std::uint32_t>(team.Uniform(0, 3));
      nodes.push_back({robot, laser, team.Ranges(laser, beams, pose)});
      poses.push_back(pose);
      incremental.AddNode(robot, laser, nodes.back().ranges, pose);
      composite.AddNode(robot, laser, nodes.back().ranges, pose);
    }
    // Some graphs move nothing, some a little, some (closures) everything by much.
    const double scale = graph % 4 == 0 ? 0 : graph % 4 == 3 ? 3 : 0.08;
    for (PlanarPose& pose : poses) {
      if (team.Uniform(0, 1) < 0.3) continue;
      pose.x += scale * team.Uniform(-1, 1);
      pose.y += scale * team.Uniform(-1, 1);
      pose.yaw += 0.2 * scale * team.Uniform(-1, 1);
    }
    incremental.UpdatePoses(poses);
    composite.UpdatePoses(poses);
    const MapUpdate update = incremental.Update();
    composite.Update();
    const auto fresh = test::Fresh(incremental, options, nodes);
    ASSERT_TRUE(test::SameMap(*incremental.Map(), *fresh)) << "graph " << graph;
    ASSERT_TRUE(test::SameMap(*incremental.Map(), *composite.Map())) << "graph " << graph;
    follower.Follow(update, *incremental.Map());
    if (HasFailure()) break;
  }
  EXPECT_GT(incremental.Cover().size(), 10u);
}

INSTANTIATE_TEST_SUITE_P(Random, LiveMapProperty,
                         ::testing::Values(Case{1, 4, true, 1, 1, {}}, Case{2, 1, false, 1, 1, {}},
                                           Case{3, 3, true, 1, 0.3, {2, 1, 1, 2, -1, 0}},
                                           Case{4, 16, false, 2, 0, {}},
                                           Case{5, 2, true, 2, 2.5, {3, 2, 0, 1, 0, 3}},
                                           Case{6, 4, false, 1, 1, {1, 1, 0, 1, 0, 1}}));

// With enough to do for all of them.
TEST(LiveMap, IsTheSameForAnyNumberOfThreads) {
  std::shared_ptr<const OccupancyMap> first;
  for (const int threads : {1, 2, 5}) {
    LiveMapOptions options;
    options.cover.on = false;
    options.threads = threads;
    LiveMap map(options);
    test::Team team(9);
    const LaserGeometry laser = test::Laser(180);
    std::vector<PlanarPose> poses;
    for (int i = 0; i < 300; ++i) {
      poses.push_back(team.Place());
      map.AddNode(0, laser, team.Ranges(laser, 180, poses.back()), poses.back());
    }
    map.Update();
    for (PlanarPose& pose : poses) pose.yaw += 0.3;
    map.UpdatePoses(poses);
    EXPECT_EQ(map.Update().regenerated_nodes, 300u);
    if (!first) first = map.Map();
    EXPECT_TRUE(test::SameMap(*map.Map(), *first)) << threads << " threads";
  }
}

TEST(LiveMap, MethodsAgreeWhereNothingIsLeftOutOrTolerated) {
  test::Team team(10);
  const LaserGeometry laser = test::Laser(180);
  std::vector<std::unique_ptr<LiveMap>> maps;
  for (const MapMethod method : {MapMethod::kNaive, MapMethod::kNaiveCover,
                                 MapMethod::kCoverComposite, MapMethod::kIncremental}) {
    LiveMapOptions options;
    options.method = method;
    options.cover.on = false;
    options.regenerate_above = 0;
    maps.push_back(std::make_unique<LiveMap>(options));
  }
  std::vector<PlanarPose> poses;
  for (int graph = 0; graph < 10; ++graph) {
    poses.push_back(team.Place());
    const std::vector<float> ranges = team.Ranges(laser, 180, poses.back());
    for (PlanarPose& pose : poses) pose.x += team.Uniform(-0.2, 0.2);
    for (const auto& map : maps) {
      map->AddNode(0, laser, ranges, poses.back());
      map->UpdatePoses(poses);
      map->Update();
    }
    for (const auto& map : maps) EXPECT_TRUE(test::SameMap(*map->Map(), *maps[0]->Map()));
  }
}

}  // namespace
}  // namespace graticule
