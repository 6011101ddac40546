#include "graticule/problems/mapping/map_error.hpp"

#include <gtest/gtest.h>

#include "graticule/problems/mapping/town.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using O = Occupancy;

OccupancyGrid Grid(std::size_t width, std::vector<O> cells) {
  OccupancyGrid grid;
  grid.width = width;
  grid.height = cells.size() / width;
  grid.cells = std::move(cells);
  return grid;
}

TEST(CompareMaps, CountsCells) {
  const auto reference = Grid(4, {O::kFree, O::kFree, O::kStructure, O::kUnknown, O::kStructure,
                                  O::kFree, O::kFree, O::kStructure});
  const auto map = Grid(4, {O::kFree, O::kStructure, O::kStructure, O::kFree, O::kUnknown, O::kFree,
                            O::kFree, O::kFree});
  const MapAgreement agreement = CompareMaps(reference, map);
  EXPECT_DOUBLE_EQ(agreement.Precision(O::kStructure), 1.0 / 2);
  EXPECT_DOUBLE_EQ(agreement.Recall(O::kStructure), 1.0 / 3);
  EXPECT_DOUBLE_EQ(agreement.Iou(O::kStructure), 1.0 / 4);
  EXPECT_DOUBLE_EQ(agreement.Precision(O::kFree), 3.0 / 4);
  EXPECT_DOUBLE_EQ(agreement.Recall(O::kFree), 3.0 / 4);
  EXPECT_DOUBLE_EQ(agreement.KnownRecall(), 6.0 / 7);
}

TEST(CompareMaps, LaysFinerCellsOnCoarser) {
  OccupancyGrid fine = Grid(4, {O::kFree, O::kFree, O::kUnknown, O::kUnknown, O::kFree,
                                O::kStructure, O::kUnknown, O::kUnknown});
  fine.resolution = 0.05;
  fine.map_from_grid = {1, 2, 0};
  OccupancyGrid map = Grid(3, {O::kStructure, O::kUnknown, O::kUnknown});
  map.map_from_grid = {1, 2, 0};
  EXPECT_EQ(Resample(fine, map).cells, map.cells);
  map.map_from_grid.yaw = 0.1;
  EXPECT_THROW(CompareMaps(fine, map), Error);
  EXPECT_THROW(CompareMaps(map, fine), Error);
}

TEST(CompareMaps, CountsCellsThatOnlyOneMapHas) {
  OccupancyGrid reference = Grid(2, {O::kFree, O::kStructure});
  OccupancyGrid map = Grid(2, {O::kStructure, O::kFree});
  map.map_from_grid = {0.1, -0.1, 0};  // below, and one cell to the right
  const MapAgreement agreement = CompareMaps(reference, map);
  EXPECT_EQ(agreement.Count(O::kFree, O::kUnknown), 1u);
  EXPECT_EQ(agreement.Count(O::kStructure, O::kUnknown), 1u);
  EXPECT_EQ(agreement.Count(O::kUnknown, O::kStructure), 1u);
  EXPECT_EQ(agreement.Count(O::kUnknown, O::kFree), 1u);
  EXPECT_EQ(agreement.Count(O::kUnknown, O::kUnknown), 2u);
  EXPECT_EQ(agreement.KnownChanged(), 1);
}

// A house of the simulated town; the map has one door closed, or one wall opened.
class Gaps : public testing::Test {
 protected:
  Gaps() {
    TownOptions options;
    options.width_m = options.height_m = 44;
    options.resolution = 0.1;
    options.yards = 0;
    town_ = MakeTown(options);
    map_ = town_.grid;
  }
  void Fill(double x, double y, double reach, O what) {
    for (std::size_t j = 0; j < map_.height; ++j)
      for (std::size_t i = 0; i < map_.width; ++i)
        if (std::abs((static_cast<double>(i) + 0.5) * 0.1 - x) < reach &&
            std::abs((static_cast<double>(j) + 0.5) * 0.1 - y) < reach)
          map_.cells[j * map_.width + i] = what;
  }
  Town town_;
  OccupancyGrid map_;
};

TEST_F(Gaps, AreNoneWhereMapsAreTheSame) {
  const GapReport report = FindGaps(town_.grid, map_, 200);
  EXPECT_EQ(report.pairs, 200u);
  EXPECT_TRUE(report.closed.empty());
  EXPECT_TRUE(report.opened.empty());
}

TEST_F(Gaps, AreFoundWhereADoorIsClosed) {
  // A door of a room, which has no other.
  const Town::Door& door = town_.doors[2];
  Fill(door.x, door.y, 0.55, O::kStructure);
  const GapReport report = FindGaps(town_.grid, map_, 800);
  EXPECT_FALSE(report.closed.empty());
  EXPECT_TRUE(report.opened.empty());
}

TEST_F(Gaps, AreFoundWhereAWallIsOpened) {
  // A room's wall to the street, beside a corner: a gap of 1 m.
  Fill(10, 8.1, 0.5, O::kFree);
  const GapReport report = FindGaps(town_.grid, map_, 800);
  EXPECT_TRUE(report.closed.empty());
  EXPECT_FALSE(report.opened.empty());
}

}  // namespace
}  // namespace graticule
