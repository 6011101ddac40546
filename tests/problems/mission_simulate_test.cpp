#include "graticule/problems/mapping/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"
#include "graticule/problems/mapping/route.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

MissionOptions Small() {
  MissionOptions options;
  options.town.width_m = options.town.height_m = 60;
  options.town.resolution = 0.1;
  options.robots = 3;
  options.duration_s = 150;
  options.people = 5;
  options.vehicles = 1;
  return options;
}

const SimulatedMission& Simulated() {
  static const SimulatedMission mission = SimulateMission(Builtins(), Small());
  return mission;
}

TEST(SimulatedMission, HasAScanOfEachRobotEverySecond) {
  EXPECT_EQ(Simulated().mission.log.scans.size(), 3u * 151u);
  EXPECT_EQ(Simulated().world_from_robot.size(), Simulated().mission.log.scans.size());
  EXPECT_GT(Simulated().mission.nodes.size(), 150u);
}

TEST(SimulatedMission, IsTheSameForTheSameSeed) {
  const SimulatedMission again = SimulateMission(Builtins(), Small());
  EXPECT_EQ(again.mission.log.ranges, Simulated().mission.log.ranges);
  MissionOptions other = Small();
  other.seed = 2;
  EXPECT_NE(SimulateMission(Builtins(), other).mission.log.ranges, Simulated().mission.log.ranges);
}

// Robots keep off walls, and what they measure is where a wall or somebody is.
TEST(SimulatedMission, BeamsEndAtStructureOrAtSomebody) {
  const SimulatedMission& mission = Simulated();
  const LaserGeometry& geometry = mission.mission.log.geometries.front();
  std::size_t beams = 0, at_structure = 0, lost = 0;
  for (std::size_t i = 0; i < mission.mission.log.scans.size(); i += 7) {
    const PlanarPose laser = mission.world_from_robot[i] * geometry.robot_from_laser;
    const auto ranges = mission.mission.log.RangesOf(mission.mission.log.scans[i]);
    for (std::size_t k = 0; k < ranges.size(); k += 5) {
      const double angle =
          laser.yaw + geometry.first_angle + static_cast<double>(k) * geometry.step;
      const double wall = CastRay(mission.town.grid, laser.x, laser.y, angle, geometry.max_range);
      EXPECT_LT(ranges[k], std::max(wall + 0.1, geometry.max_range + 1e-3));
      ++beams;
      at_structure += std::abs(ranges[k] - wall) < 0.1;
      lost += ranges[k] >= geometry.max_range && wall < geometry.max_range - 0.1;
    }
  }
  EXPECT_GT(at_structure, 0.85 * static_cast<double>(beams));
  EXPECT_GT(lost, 0u);
  EXPECT_LT(lost, 0.02 * static_cast<double>(beams));
}

TEST(SimulatedMission, HasAGraphThatSolvesToTheTruth) {
  const SimulatedMission& mission = Simulated();
  const Solution solution = Solve(mission.mission.graph);
  double worst = 0;
  for (const MissionNode& node : mission.mission.nodes) {
    const double* value = solution.values[node.variable].data();
    const PlanarPose& truth = mission.world_from_robot[node.scan];
    worst = std::max(worst, std::hypot(value[0] - truth.x, value[1] - truth.y));
  }
  EXPECT_LT(worst, 1.0);
  // The noise of the factors is what they say.
  EXPECT_NEAR(solution.report.ReducedChi2(), 1, 0.35);
}

TEST(SimulatedMission, MarksWhereSomebodyWalked) {
  std::size_t swept = 0, in_walls = 0;
  const SimulatedMission& mission = Simulated();
  for (std::size_t i = 0; i < mission.is_swept.size(); ++i) {
    swept += mission.is_swept[i];
    in_walls += mission.is_swept[i] && mission.town.grid.cells[i] == Occupancy::kStructure;
  }
  EXPECT_GT(swept, 1000u);
  EXPECT_EQ(in_walls, 0u);
}

TEST(SimulatedMission, RefusesWhatMakesNoSense) {
  MissionOptions options = Small();
  options.robots = 0;
  EXPECT_THROW(SimulateMission(Builtins(), options), Error);
  options = Small();
  options.town.width_m = 10;
  EXPECT_THROW(SimulateMission(Builtins(), options), Error);
}

// The sequence of graphs ends where the whole graph does.
TEST(MissionReplay, EndsAtTheMinimumOfTheWholeGraph) {
  const Mission& mission = Simulated().mission;
  MissionReplay replay(mission, 10);
  MissionStep step;
  std::size_t steps = 0, nodes = 0;
  while (replay.Next(&step)) {
    ++steps;
    EXPECT_GT(step.nodes, nodes);
    nodes = step.nodes;
    EXPECT_EQ(step.world_from_robot.size(), nodes);
    EXPECT_LE(mission.TimeOf(mission.nodes[nodes - 1]), step.time);
  }
  EXPECT_EQ(steps, 15u);
  EXPECT_EQ(nodes, mission.nodes.size());
  const Solution whole = Solve(mission.graph);
  for (std::size_t i = 0; i < nodes; ++i) {
    const double* value = whole.values[mission.nodes[i].variable].data();
    EXPECT_NEAR(step.world_from_robot[i].x, value[0], 1e-4);
    EXPECT_NEAR(step.world_from_robot[i].yaw, value[2], 1e-5);
  }
  EXPECT_EQ(replay.Problem().FactorCount(), mission.graph.FactorCount());
}

TEST(RoutePlanner, GoesThroughTheDoor) {
  // Two rooms of 5 m, with a door of 1 m at the upper end of the wall between.
  OccupancyGrid grid;
  grid.resolution = 0.1;
  grid.width = 100;
  grid.height = 50;
  for (std::size_t y = 0; y < 50; ++y)
    for (std::size_t x = 0; x < 100; ++x)
      grid.cells.push_back(x == 50 && (y < 38 || y > 47) ? Occupancy::kStructure
                                                         : Occupancy::kFree);
  const RoutePlanner planner(grid, 0.2, 0.25);
  const auto route = planner.Route({1, 1}, {9, 1});
  ASSERT_GE(route.size(), 3u);
  double length = 0;
  for (std::size_t i = 0; i + 1 < route.size(); ++i) {
    const double dx = route[i + 1].x - route[i].x, dy = route[i + 1].y - route[i].y;
    length += std::hypot(dx, dy);
    EXPECT_GE(CastRay(grid, route[i].x, route[i].y, std::atan2(dy, dx), std::hypot(dx, dy)),
              std::hypot(dx, dy) - 1e-9);
  }
  EXPECT_NEAR(length, 2 * std::hypot(4, 3), 0.8);
}

TEST(CastRay, MeasuresToTheCell) {
  OccupancyGrid grid;
  grid.resolution = 0.5;
  grid.width = grid.height = 20;
  grid.cells.assign(400, Occupancy::kFree);
  for (std::size_t y = 0; y < 20; ++y) grid.cells[y * 20 + 15] = Occupancy::kStructure;
  EXPECT_NEAR(CastRay(grid, 1.2, 5.1, 0, 30), 6.3, 1e-12);
  EXPECT_NEAR(CastRay(grid, 1.2, 5.1, 0.3, 30), 6.3 / std::cos(0.3), 1e-12);
  EXPECT_EQ(CastRay(grid, 1.2, 5.1, M_PI, 30), 30) << "out of the map";
  EXPECT_EQ(CastRay(grid, 1.2, 5.1, 0, 4), 4) << "not so far";
}

}  // namespace
}  // namespace graticule
