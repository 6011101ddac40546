#include "graticule/problems/mapping/transients.hpp"

#include <gtest/gtest.h>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/mapping/map_error.hpp"
#include "graticule/problems/mapping/simulate.hpp"
#include "room.hpp"

namespace graticule {
namespace {

using test::Laser;
using test::SweepRoom;

TEST(Transients, AreALayerOnTheCellsOfTheMap) {
  LiveMapOptions options;
  options.cover.on = false;
  LiveMap map(options);
  const LaserGeometry laser = Laser(3600);
  const PlanarPose pose{2.05, 1.55, 0};  // so that walls lie in the middle of a cell
  const std::vector<float> empty = SweepRoom(laser, 3600, {2, 1.5, 0}, 4, 3);
  std::vector<float> person = empty;
  for (std::size_t i = 1780; i < 1820; ++i) person[i] = 1;
  map.AddNode(0, laser, person, pose);
  for (int i = 0; i < 4; ++i) map.AddNode(0, laser, empty, pose);
  map.Update();

  const OccupancyGrid grid = map.Map()->Grid();
  const OccupancyGrid layer = TransientsOf(*map.Map());
  ASSERT_EQ(layer.width, grid.width);
  ASSERT_EQ(layer.height, grid.height);
  EXPECT_EQ(layer.resolution, grid.resolution);
  EXPECT_EQ(layer.map_from_grid.x, grid.map_from_grid.x);
  EXPECT_EQ(layer.map_from_grid.y, grid.map_from_grid.y);
  EXPECT_EQ(grid.At(30, 15), Occupancy::kFree);
  EXPECT_EQ(layer.At(30, 15), Occupancy::kStructure);  // the person
  EXPECT_EQ(layer.At(25, 15), Occupancy::kFree);       // nobody
  EXPECT_EQ(grid.At(40, 15), Occupancy::kStructure);
  EXPECT_EQ(layer.At(40, 15), Occupancy::kFree);  // a wall, which stays in the map
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    EXPECT_EQ(layer.cells[i] == Occupancy::kUnknown, grid.cells[i] == Occupancy::kUnknown);
    if (layer.cells[i] == Occupancy::kStructure) {
      EXPECT_EQ(grid.cells[i], Occupancy::kFree);
    }
  }
}

// Away from walls, where noise and corners are removed too, what is removed is where somebody was.
TEST(Transients, AreWherePeopleWent) {
  MissionOptions options;
  options.town.width_m = 50;
  options.town.height_m = 50;
  options.robots = 1;
  options.duration_s = 180;
  options.people = 15;
  const SimulatedMission simulated = SimulateMission(Builtins(), options);
  const LaserLog& log = simulated.mission.log;
  LiveMap map;
  for (const MissionNode& node : simulated.mission.nodes) {
    const LaserScan& scan = log.scans[node.scan];
    map.AddNode(scan.robot, log.GeometryOf(scan), log.RangesOf(scan),
                simulated.world_from_robot[node.scan]);
  }
  map.Update();
  const OccupancyGrid layer = TransientsOf(*map.Map());
  const OccupancyGrid town = Resample(simulated.town.grid, layer);
  OccupancyGrid swept = simulated.town.grid;
  for (std::size_t i = 0; i < swept.cells.size(); ++i)
    swept.cells[i] = simulated.is_swept[i] ? Occupancy::kStructure : Occupancy::kFree;
  swept = Resample(swept, layer);

  const auto is_near = [](const OccupancyGrid& grid, std::size_t x, std::size_t y,
                          std::size_t cells) {
    for (std::size_t v = y - cells; v <= y + cells; ++v)
      for (std::size_t u = x - cells; u <= x + cells; ++u)
        if (grid.At(u, v) == Occupancy::kStructure) return true;
    return false;
  };
  std::size_t removed = 0, people = 0;
  for (std::size_t y = 3; y + 3 < layer.height; ++y)
    for (std::size_t x = 3; x + 3 < layer.width; ++x) {
      if (layer.At(x, y) != Occupancy::kStructure || is_near(town, x, y, 3)) continue;
      ++removed;
      people += is_near(swept, x, y, 1);  // measured ranges have noise
    }
  EXPECT_GT(removed, 100u);
  EXPECT_GT(people, removed * 98 / 100) << removed;
}

}  // namespace
}  // namespace graticule
