#include "graticule/io/map_drawing.hpp"

#include <gtest/gtest.h>

#include "graticule/io/grey_image.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

// A room of 40 x 20 m, 200 x 100 cells, with the origin in its middle.
MapDrawing Room() {
  MapDrawing drawing;
  drawing.title = "room";
  drawing.grid.resolution = 0.2;
  drawing.grid.map_from_grid = {-20, -10, 0};
  drawing.grid.width = 200;
  drawing.grid.height = 100;
  for (std::size_t y = 0; y < 100; ++y)
    for (std::size_t x = 0; x < 200; ++x)
      drawing.grid.cells.push_back(x == 0 || y == 0 || x == 199 || y == 99 ? Occupancy::kStructure
                                                                           : Occupancy::kFree);
  drawing.trajectories = {{"robot1", {{-15, 0}, {15, 0}}}, {"robot2", {{0, -8}, {0, 8}}}};
  drawing.closures = {{{-15, 0}, {0, 8}}};
  return drawing;
}

TEST(DrawMap, PutsTrajectoriesWhereTheMapIs) {
  const std::string svg = DrawMap(Room());
  // 1168 pixels for 40 m: 29.2 pixels a metre, (0, 0) in the middle.
  EXPECT_NE(svg.find("d=\"m146 292 876 0\""), std::string::npos)
      << "robot1 begins 5 m from the left";
  EXPECT_NE(svg.find("1 loop closure"), std::string::npos);
}

TEST(DrawMap, ShowsThePictureOfTheMap) {
  const GreyImage image = ParseGreyImage(PngFromSvg(DrawMap(Room()), 1200), "png");
  const auto shade = [&](double x, double y) {  // of a point of the room
    const auto column = static_cast<std::size_t>(16 + (x + 20) * 29.2);
    const auto row = static_cast<std::size_t>(58 + (10 - y) * 29.2);
    return static_cast<int>(image.shades[row * image.width + column]);
  };
  EXPECT_GT(shade(5, 5), 240);
  EXPECT_LT(shade(-19.9, 5), 60);
  EXPECT_LT(shade(5, -9.9), 60);
}

TEST(DrawMap, LeavesNoMarginBesideATallMap) {
  MapDrawing tall = Room();
  std::swap(tall.grid.width, tall.grid.height);
  tall.grid.cells.assign(tall.grid.cells.size(), Occupancy::kFree);
  // 1600 pixels for 40 m, 800 for 20 m, and a margin of 16 on either side.
  EXPECT_NE(DrawMap(tall).find("width=\"832\""), std::string::npos);
}

TEST(DrawMap, DrawsAnEmptyMap) { EXPECT_NE(DrawMap({}).find("</svg>"), std::string::npos); }

}  // namespace
}  // namespace graticule
