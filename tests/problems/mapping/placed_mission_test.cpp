#include "graticule/problems/mapping/placed_mission.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "../../solver/expect_error.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"

namespace graticule {
namespace {

// Two robots that scan every second; the second begins elsewhere and turns on the spot.
LaserLog Log() {
  LaserLog log;
  log.robots = {"a", "b"};
  log.geometries.emplace_back();
  log.geometries[0].max_range = 30;
  for (int i = 0; i < 20; ++i)
    for (const std::uint32_t robot : {0u, 1u}) {
      LaserScan scan;
      scan.time = i;
      scan.robot = robot;
      scan.odom_from_robot =
          robot == 0 ? PlanarPose{0.05 * i, 0, 0} : PlanarPose{7, -3, WrappedAngle(0.3 * i)};
      scan.first_range = log.ranges.size();
      scan.beams = 1;
      log.ranges.push_back(2);
      log.scans.push_back(scan);
    }
  return log;
}

TEST(PlacedMission, KeepsThePosesOfTheLog) {
  const Mission mission = MissionAsPlaced(Log(), Builtins());
  std::size_t of_b = 0;
  for (const MissionNode& node : mission.nodes) of_b += mission.log.scans[node.scan].robot == 1;
  EXPECT_EQ(of_b, 20u) << "each turn of 0.3 rad is a node";
  EXPECT_EQ(mission.nodes.size() - of_b, 5u) << "every 0.2 m of 0.95 m";
  EXPECT_EQ(mission.graph.FactorCount(), mission.nodes.size() - 2);
  for (std::size_t i = 1; i < mission.nodes.size(); ++i)
    EXPECT_LE(mission.TimeOf(mission.nodes[i - 1]), mission.TimeOf(mission.nodes[i]));

  MissionReplay replay(mission, 5);
  MissionStep step;
  std::size_t steps = 0;
  while (replay.Next(&step)) {
    ++steps;
    for (std::size_t i = 0; i < step.nodes; ++i) {
      const PlanarPose& log = mission.log.scans[mission.nodes[i].scan].odom_from_robot;
      EXPECT_NEAR(step.world_from_robot[i].x, log.x, 1e-9);
      EXPECT_NEAR(step.world_from_robot[i].y, log.y, 1e-9);
      EXPECT_NEAR(WrappedAngle(step.world_from_robot[i].yaw - log.yaw), 0, 1e-9);
    }
  }
  EXPECT_EQ(steps, 4u);
}

TEST(PlacedMission, HasNoNodesOfAnEmptyLog) {
  EXPECT_TRUE(MissionAsPlaced({}, Builtins()).nodes.empty());
}

TEST(PlacedMission, RefusesNodesThatAreNoDistanceApart) {
  testing::ExpectError(ErrorKind::kUsage, {"above 0"},
                       [] { MissionAsPlaced(Log(), Builtins(), 0); });
}

}  // namespace
}  // namespace graticule
