#include "graticule/problems/mapping/live_map.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <thread>

#include "../../solver/expect_error.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/mapping/projection_error.hpp"
#include "graticule/solver/graph.hpp"
#include "room.hpp"

namespace graticule {
namespace {

using test::Laser;
using test::SweepRoom;
using testing::ExpectError;

LiveMapOptions WithoutCover() {
  LiveMapOptions options;
  options.cover.on = false;
  return options;
}

TEST(LiveMap, TakesPosesOfAGraph) {
  const LaserGeometry laser = Laser(360);
  Graph graph(Builtins());
  std::vector<Key> keys;
  std::vector<PlanarPose> poses;
  LiveMap by_values, by_poses;
  for (const unsigned number : {7u, 3u}) {  // not in the graph's order
    const PlanarPose pose{2.0 + number / 10.0, 3, 0.1 * number};
    keys.emplace_back("pose", number);
    poses.push_back(pose);
    graph.Add(keys.back(), "se2/1", {pose.x, pose.y, pose.yaw});
    for (LiveMap* map : {&by_values, &by_poses})
      map->AddNode(0, laser, SweepRoom(laser, 360, pose, 6, 5), {});
  }
  by_values.UpdatePoses(graph.InitialValues(), keys);
  by_poses.UpdatePoses(poses);
  by_values.Update();
  by_poses.Update();
  EXPECT_GT(by_poses.Map()->Grid().cells.size(), 100u);
  EXPECT_EQ(by_values.Map()->Grid().cells, by_poses.Map()->Grid().cells);
}

TEST(LiveMap, MapsARoom) {
  LiveMap map(WithoutCover());
  EXPECT_EQ(map.Map()->Version(), 0u);
  EXPECT_EQ(map.Map()->Grid().cells.size(), 0u);
  const LaserGeometry laser = Laser(3600);
  map.AddNode(7, laser, SweepRoom(laser, 3600, {2, 1.5, 0}, 4, 3), {2.05, 1.55, 0});
  const MapUpdate update = map.Update();
  EXPECT_EQ(update.nodes, 1u);
  EXPECT_EQ(update.cover, 1u);
  EXPECT_EQ(update.version, 1u);
  const auto seen = map.Map();
  const OccupancyGrid grid = seen->Grid();
  EXPECT_EQ(grid.width, 41u);
  EXPECT_EQ(grid.height, 31u);
  EXPECT_DOUBLE_EQ(grid.map_from_grid.x, 0);
  EXPECT_EQ(grid.At(20, 0), Occupancy::kStructure);
  EXPECT_EQ(grid.At(20, 15), Occupancy::kFree);
  EXPECT_EQ(seen->AtPlace(2, 1.5), Occupancy::kFree);
  EXPECT_EQ(seen->AtPlace(4.05, 1.5), Occupancy::kStructure);
  EXPECT_EQ(seen->AtPlace(4.15, 1.5), Occupancy::kUnknown);
  EXPECT_EQ(seen->AtPlace(NAN, 1e300), Occupancy::kUnknown);
  // Behind walls all around there is no frontier but at the corners, which no beam ends in.
  EXPECT_LE(update.change.frontier_came.size(), 8u);
  // All that is known has flipped from unknown.
  std::size_t known = 0;
  for (const Occupancy cell : grid.cells) known += cell != Occupancy::kUnknown;
  EXPECT_EQ(update.change.flips.size(), known);
  EXPECT_EQ(seen->ChangedSince(0), update.change.changed_tiles);
  EXPECT_TRUE(seen->ChangedSince(1).empty());
}

TEST(LiveMap, WhatPassedThroughVanishesByTheVote) {
  LiveMapOptions options = WithoutCover();
  options.votes.hit_votes = 3;
  LiveMap map(options);
  const LaserGeometry laser = Laser(720);
  const std::vector<float> empty = SweepRoom(laser, 720, {2, 1.5, 0}, 4, 3);
  std::vector<float> person = empty;
  for (std::size_t i = 350; i < 370; ++i) person[i] = 1;
  const PlanarPose pose{2.05, 1.55, 0};
  for (int i = 0; i < 2; ++i) map.AddNode(0, laser, person, pose);
  map.Update();
  EXPECT_EQ(map.Map()->AtPlace(3.05, 1.55), Occupancy::kStructure);
  // Two hits outweigh five passes, but not six.
  for (int i = 0; i < 5; ++i) map.AddNode(0, laser, empty, pose);
  map.Update();
  EXPECT_EQ(map.Map()->AtPlace(3.05, 1.55), Occupancy::kStructure);
  map.AddNode(0, laser, empty, pose);
  const MapUpdate update = map.Update();
  EXPECT_EQ(map.Map()->AtPlace(3.05, 1.55), Occupancy::kFree);
  EXPECT_TRUE(map.Map()->IsRemoved(30, 15));
  EXPECT_FALSE(map.Map()->IsRemoved(25, 15));
  EXPECT_EQ(map.Map()->AtPlace(4.05, 1.55), Occupancy::kStructure);
  bool flipped = false;
  for (const CellFlip& flip : update.change.flips)
    flipped |= flip.cell.x == 30 && flip.cell.y == 15 && flip.from == Occupancy::kStructure &&
               flip.to == Occupancy::kFree;
  EXPECT_TRUE(flipped);
}

TEST(LiveMap, RegeneratesExactlyWhenTheFarthestBeamMovesByMoreThanTheThreshold) {
  LaserGeometry laser = Laser(2);
  laser.first_angle = 0;
  laser.step = test::kPi / 2;  // 20 m ahead, 3 m to the left
  const std::vector<float> ranges = {20, 3};
  const auto regenerated = [&](const PlanarPose& moved) {
    LiveMap map(WithoutCover());
    map.AddNode(0, laser, ranges, {1, 2, 0});
    map.Update();
    map.UpdatePose(0, moved);
    const MapUpdate update = map.Update();
    EXPECT_EQ(update.regenerated_nodes, update.regenerated_slices);
    return update.regenerated_slices > 0;
  };
  EXPECT_FALSE(regenerated({1.0999, 2, 0}));
  EXPECT_TRUE(regenerated({1.1001, 2, 0}));
  // A turn: the chord of the far beam is 2 * 20 sin(turn / 2).
  const double turn = 2 * std::asin(0.1 / 40);
  EXPECT_FALSE(regenerated({1, 2, 0.999 * turn}));
  EXPECT_TRUE(regenerated({1, 2, 1.001 * turn}));
  // A shift that undoes the turn at the far beam, and doubles it behind the robot, where no beam
  // is: what the laser itself moves by counts.
  EXPECT_FALSE(regenerated({1, 2 - 0.09, 0.9 * turn}));
  EXPECT_TRUE(regenerated({1, 2 - 0.11, 1.1 * turn}));
  // A full turn is none.
  EXPECT_FALSE(regenerated({1, 2, 2 * test::kPi}));
}

TEST(LiveMap, TheHullOfAScanMovesAsFarAsAllOfIt) {
  test::Team team(8);
  for (int round = 0; round < 400; ++round) {
    LaserGeometry laser = Laser(round % 3 ? 180 : 361, round % 2 ? test::kPi : 2 * test::kPi);
    if (round % 5 == 0) laser.step = -laser.step;
    if (round % 7 == 0) laser.step *= round % 2 ? 0 : 3;  // one direction; several rounds
    laser.robot_from_laser = {team.Uniform(-1, 1), team.Uniform(-1, 1), team.Uniform(-4, 4)};
    const int beams = round % 3 ? 180 : 361;
    const ScanPoints points = ScanReader({}).Read(laser, team.Ranges(laser, beams, team.Place()));
    ASSERT_LE(points.hull_x.size(), points.Size());
    EXPECT_TRUE(round % 7 == 0 || points.hull_x.size() < 60);
    const PlanarPose then = team.Place();
    const PlanarPose now = then * PlanarPose{team.Uniform(-0.1, 0.1), team.Uniform(-0.1, 0.1),
                                             team.Uniform(-0.02, 0.02)};
    double most = 0;
    const auto include = [&](double x, double y) {
      double from_x, from_y, to_x, to_y;
      then.Transform(x, y, &from_x, &from_y);
      now.Transform(x, y, &to_x, &to_y);
      most = std::max(most, std::hypot(to_x - from_x, to_y - from_y));
    };
    include(points.laser_x, points.laser_y);
    for (std::size_t i = 0; i < points.Size(); ++i) include(points.x[i], points.y[i]);
    EXPECT_NEAR(ProjectionError(points, then, now), most, 1e-9);
  }
}

TEST(LiveMap, DrawsASliceAnewAsOne) {
  LiveMapOptions options = WithoutCover();
  options.slice_size = 3;
  LiveMap map(options);
  const LaserGeometry laser = Laser(90);
  for (std::uint32_t i = 0; i < 10; ++i)
    map.AddNode(i % 2, laser, SweepRoom(laser, 90, {2, 1.5, 0}, 4, 3), {2.05, 1.55, 0});
  EXPECT_EQ(map.Update().slices, 4u);  // 5 nodes a robot: 3 and 2
  map.UpdatePose(4, {2.5, 1.55, 0});
  const MapUpdate update = map.Update();
  EXPECT_EQ(update.regenerated_slices, 1u);
  EXPECT_EQ(update.regenerated_nodes, 3u);
  EXPECT_EQ(map.Update().change.dirty_tiles, 0u);
}

TEST(LiveMap, TheCoverLeavesOutWhatHasBeenSeenOftenEnough) {
  LiveMapOptions options;
  options.cover.views = 2;
  const LaserGeometry laser = Laser(360);
  const std::vector<float> ranges = SweepRoom(laser, 360, {2, 1.5, 0}, 4, 3);
  LiveMap map(options);
  for (int i = 0; i < 5; ++i) map.AddNode(0, laser, ranges, {2.05, 1.55, 0});
  EXPECT_EQ(map.Update().cover, 2u);
  EXPECT_EQ(map.Cover(), (std::vector<NodeId>{0, 1}));
  // Another robot has a cover of its own (Algorithm 2.1) ...
  map.AddNode(1, laser, ranges, {2.05, 1.55, 0});
  EXPECT_EQ(map.Update().cover, 3u);
  // ... unless covers are shared.
  options.cover.across_robots = true;
  LiveMap shared(options);
  for (std::uint32_t i = 0; i < 5; ++i) shared.AddNode(i, laser, ranges, {2.05, 1.55, 0});
  EXPECT_EQ(shared.Update().cover, 2u);
  // A cover that has moved away has not seen the place.
  for (NodeId id = 0; id < 2; ++id) shared.UpdatePose(id, {50, 50, 0});
  shared.Update();
  shared.AddNode(9, laser, ranges, {2.05, 1.55, 0});
  EXPECT_EQ(shared.Update().cover, 3u);
}

TEST(LiveMap, StopsForADeadlineNamesWhatIsLeftAndFinishesLater) {
  LiveMapOptions options = WithoutCover();
  options.slice_size = 2;
  LiveMap map(options);
  test::Team team(5);
  const LaserGeometry laser = Laser(720);
  std::vector<test::Node> nodes;
  std::vector<PlanarPose> poses;
  for (std::uint32_t i = 0; i < 600; ++i) {
    poses.push_back(team.Place());
    nodes.push_back({i % 3, laser, team.Ranges(laser, 720, poses.back())});
    map.AddNode(nodes[i].robot, laser, nodes[i].ranges, poses[i]);
  }
  map.Update();
  for (PlanarPose& pose : poses) pose.x += 1;
  map.UpdatePoses(poses);
  MapUpdate update = map.Update(1e-3);
  ASSERT_FALSE(update.left_over.empty());
  for (const StaleSlice& slice : update.left_over) {
    EXPECT_NEAR(slice.error, 10, 1e-4);
    EXPECT_EQ(nodes[slice.first].robot, slice.robot);
    EXPECT_EQ(map.DrawnPose(slice.first).x + 1, poses[slice.first].x);
  }
  EXPECT_TRUE(test::SameMap(*map.Map(), *test::Fresh(map, options, nodes)));
  // One that is not possible does a little nevertheless, so that it ends some time.
  const std::size_t left = update.left_over.size();
  update = map.Update(0);
  EXPECT_EQ(update.left_over.size(), left - 1);
  const NodeId extra = map.AddNode(0, laser, nodes[0].ranges, poses[0]);
  nodes.push_back({0, laser, nodes[0].ranges});
  update = map.Update(0);
  EXPECT_EQ(update.waiting, std::vector<NodeId>{extra});
  for (int i = 0; i < 2000 && !(update.left_over.empty() && update.waiting.empty()); ++i)
    update = map.Update(1e-3);
  EXPECT_TRUE(update.left_over.empty());
  for (NodeId id = 0; id < poses.size(); ++id) EXPECT_EQ(map.DrawnPose(id).x, poses[id].x);
  EXPECT_TRUE(test::SameMap(*map.Map(), *test::Fresh(map, options, nodes)));
}

TEST(LiveMap, ReadersKeepTheirVersion) {
  LiveMap map(WithoutCover());
  const LaserGeometry laser = Laser(360);
  const std::vector<float> ranges = SweepRoom(laser, 360, {2, 1.5, 0}, 4, 3);
  map.AddNode(0, laser, ranges, {2.05, 1.55, 0});
  map.Update();
  const auto before = map.Map();
  const OccupancyGrid grid = before->Grid();
  map.UpdatePose(0, {30, 30, 1});
  map.Update();
  EXPECT_EQ(before->Grid().cells, grid.cells);
  EXPECT_EQ(before->Version(), 1u);
  EXPECT_EQ(map.Map()->Version(), 2u);
  EXPECT_EQ(map.Map()->AtPlace(2.05, 1.55), Occupancy::kUnknown);
  // Nothing changed: nothing is published.
  const auto same = map.Map();
  map.UpdatePose(0, {30.01, 30, 1});
  map.Update();
  EXPECT_EQ(map.Map(), same);
}

TEST(LiveMap, IsReadByOtherThreadsWhileItIsUpdated) {
  LiveMap map(WithoutCover());
  const LaserGeometry laser = Laser(360);
  const std::vector<float> ranges = SweepRoom(laser, 360, {2, 1.5, 0}, 4, 3);
  const NodeId node = map.AddNode(0, laser, ranges, {2.05, 1.55, 0});
  map.Update();
  const auto count = [](const OccupancyMap& seen) {
    const OccupancyGrid grid = seen.Grid();
    return std::count(grid.cells.begin(), grid.cells.end(), Occupancy::kStructure);
  };
  const auto cells = count(*map.Map());
  std::atomic<bool> done{false};
  std::atomic<int> wrong{0}, reads{0};
  std::thread reader([&] {
    std::uint64_t last = 0;
    while (!done) {
      const auto seen = map.Map();
      // Shifts by whole tiles: every version has the same number of cells.
      if (count(*seen) != cells || seen->Version() < last) ++wrong;
      last = seen->Version();
      ++reads;
    }
  });
  for (int i = 1; i <= 200 || reads < 3; ++i) {
    map.UpdatePose(node, {2.05 + 1.6 * (i % 7), 1.55 + 1.6 * (i % 5), 0});
    map.Update();
  }
  done = true;
  reader.join();
  EXPECT_EQ(wrong, 0);
}

TEST(LiveMap, RefusesBadInputAndStaysAsItWas) {
  LiveMap map(WithoutCover());
  const LaserGeometry laser = Laser(4);
  const std::vector<float> ranges = {1, 1, 1, 1};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  map.AddNode(0, laser, ranges, {1, 1, 0});
  map.Update();
  const auto before = map.Map();
  ExpectError(ErrorKind::kInput, {"no beams"}, [&] { map.AddNode(0, laser, {}, {}); });
  ExpectError(ErrorKind::kInput, {"node 1", "not finite"}, [&] {
    map.AddNode(0, laser, ranges, {nan, 0, 0});
  });
  ExpectError(ErrorKind::kInput, {"node 1", "too far away"}, [&] {
    map.AddNode(0, laser, ranges, {1e9, 0, 0});
  });
  ExpectError(ErrorKind::kInput, {"node 0", "too far away"}, [&] {
    map.UpdatePose(0, {1e5, 1e5, 0});
  });
  ExpectError(ErrorKind::kInput, {"expected a node below 1", "found 1"},
              [&] { map.UpdatePose(1, {}); });
  ExpectError(ErrorKind::kInput, {"1 nodes, found 2"},
              [&] { map.UpdatePoses(std::vector<PlanarPose>(2)); });
  Graph graph(Builtins());
  graph.Add(Key("pose:0"), "se2/1", {0, 0, 0});
  graph.Add(Key("place:0"), "point2/1", {0, 0});
  const Values values = graph.InitialValues();
  ExpectError(ErrorKind::kInput, {"place:0", "se2/1", "2 numbers"},
              [&] { map.UpdatePoses(values, {Key("place:0")}); });
  ExpectError(ErrorKind::kInput, {"pose:1"}, [&] { map.UpdatePoses(values, {Key("pose:1")}); });
  ExpectError(ErrorKind::kInput, {"1 nodes, found 0"}, [&] { map.UpdatePoses(values, {}); });
  ExpectError(ErrorKind::kInput, {"not in the cover"}, [&] { map.DrawnPose(5); });
  EXPECT_EQ(map.NodeCount(), 1u);
  map.Update();
  EXPECT_EQ(map.Map(), before);

  const auto refused = [](void (*change)(LiveMapOptions*), const char* what) {
    LiveMapOptions options;
    change(&options);
    ExpectError(ErrorKind::kUsage, {what}, [&] { LiveMap bad(options); });
  };
  refused([](LiveMapOptions* o) { o->resolution = 0; }, "resolution");
  refused([](LiveMapOptions* o) { o->ranges.max_range = 1e6; }, "max_range");
  refused([](LiveMapOptions* o) { o->slice_size = 0; }, "slice_size");
  refused([](LiveMapOptions* o) { o->regenerate_above = -1; }, "regenerate_above");
  refused([](LiveMapOptions* o) { o->cover.news = 2; }, "cover.news");
  refused([](LiveMapOptions* o) { o->cover.views = 0; }, "cover.views");
  refused([](LiveMapOptions* o) { o->threads = 0; }, "threads");
}

// What the tolerance leaves where it was is drawn where it is.
TEST(LiveMap, UpdatesExactlyToWhereNodesAre) {
  LiveMapOptions options;
  options.cover.on = false;
  LiveMap tolerant(options), fresh(options);
  test::Team team(5);
  const LaserGeometry laser = Laser(180);
  std::vector<PlanarPose> poses;
  for (int i = 0; i < 30; ++i) {
    const PlanarPose pose = team.Place();
    const std::vector<float> ranges = team.Ranges(laser, 180, pose);
    tolerant.AddNode(0, laser, ranges, pose);
    poses.push_back(pose * PlanarPose{0.03, -0.02, 0.001});
    fresh.AddNode(0, laser, ranges, poses.back());
  }
  tolerant.Update();
  tolerant.UpdatePoses(poses);
  fresh.Update();
  tolerant.Update();
  EXPECT_FALSE(test::SameMap(*tolerant.Map(), *fresh.Map()));
  EXPECT_GT(tolerant.UpdateExactly().regenerated_nodes, 20u);
  EXPECT_TRUE(test::SameMap(*tolerant.Map(), *fresh.Map()));
  EXPECT_EQ(tolerant.UpdateExactly().regenerated_nodes, 0u);
}

}  // namespace
}  // namespace graticule
