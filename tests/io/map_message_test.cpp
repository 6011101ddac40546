#include "graticule/io/map_message.hpp"

#include <gtest/gtest.h>

namespace graticule {
namespace {

TEST(MapMessage, HasRosNumbersRowByRow) {
  OccupancyGrid grid;
  grid.width = 2;
  grid.height = 2;
  using O = Occupancy;
  grid.cells = {O::kStructure, O::kFree,  // the lower row
                O::kUnknown, O::kStructure};
  EXPECT_EQ(MapMessageData(grid), (std::vector<std::int8_t>{100, 0, -1, 100}));
  EXPECT_TRUE(MapMessageData({}).empty());
}

}  // namespace
}  // namespace graticule
