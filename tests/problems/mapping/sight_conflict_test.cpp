#include "graticule/problems/mapping/sight_conflict.hpp"

#include <gtest/gtest.h>

#include "room.hpp"

namespace graticule {
namespace {

// What a laser in the middle of a room sees, in the laser's frame.
std::shared_ptr<const OccupancyMap> Room(double width, double height) {
  LiveMap map;
  const LaserGeometry laser = test::Laser(1800);
  map.AddNode(0, laser, test::SweepRoom(laser, 1800, {width / 2, height / 2, 0}, width, height),
              {});
  map.Update();
  return map.Map();
}

TEST(SightConflict, IsNoneOfARoomWithItself) {
  const auto room = Room(8, 5);
  for (const double yaw : {0.0, test::kPi}) {
    const SightConflict conflict = ConflictOf(*room, *room, {0, 0, yaw});
    EXPECT_GT(conflict.agree, 300u);
    EXPECT_EQ(conflict.Share(), 0);
  }
  EXPECT_EQ(ConflictOf(*room, *room, {0.15, -0.1, 0.01}).Share(), 0) << "poses are not exact";
}

TEST(SightConflict, IsWhereOneSeesThroughTheWallOfTheOther) {
  // The long walls of the smaller stand in the middle of the larger.
  EXPECT_GT(ConflictOf(*Room(12, 9), *Room(8, 5), {}).Share(), 0.9);
  EXPECT_GT(ConflictOf(*Room(8, 5), *Room(8, 5), {0, 0, test::kPi / 2}).Share(), 0.3);
}

TEST(SightConflict, IsNothingToGoByWhereLittleIsInSight) {
  const SightConflict apart = ConflictOf(*Room(8, 5), *Room(8, 5), {50, 0, 0});
  EXPECT_EQ(apart.agree + apart.conflict, 0u);
  EXPECT_EQ(apart.Share(), 0);
}

}  // namespace
}  // namespace graticule
