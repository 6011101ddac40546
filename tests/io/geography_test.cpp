#include "graticule/io/geography.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace graticule {
namespace {

TEST(WorldFile, NamesTheCentreOfTheUpperLeftPixel) {
  OccupancyGrid grid;
  grid.resolution = 0.5;
  grid.map_from_grid = {10, 20, 0};
  grid.width = 4;
  grid.height = 3;
  EXPECT_EQ(FormatWorldFile(grid), "0.5\n0\n0\n-0.5\n10.25\n21.25\n");
}

TEST(WorldFile, TurnsWithItsGrid) {
  OccupancyGrid grid;
  grid.resolution = 1;
  grid.map_from_grid = {0, 0, M_PI / 2};
  grid.width = grid.height = 2;
  double a[6];
  ASSERT_EQ(std::sscanf(FormatWorldFile(grid).c_str(), "%lf %lf %lf %lf %lf %lf", a, a + 1, a + 2,
                        a + 3, a + 4, a + 5),
            6);
  // To the right is north, down is east: the upper left pixel lies in the south west.
  const double expected[] = {0, 1, 1, 0, -1.5, 0.5};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(a[i], expected[i], 1e-15) << i;
}

TEST(GeoJson, HasALineARobot) {
  const auto json = nlohmann::json::parse(
      FormatGeoJson({{"robot \"1\"", {{42.5, -83.5, 250}, {42.6, -83.4, 251}}}, {"robot2", {}}}));
  EXPECT_EQ(json["type"], "FeatureCollection");
  ASSERT_EQ(json["features"].size(), 2u);
  EXPECT_EQ(json["features"][0]["properties"]["name"], "robot \"1\"");
  EXPECT_EQ(json["features"][0]["geometry"]["coordinates"][1],
            nlohmann::json({-83.4, 42.6, 251.0}));
}

TEST(Kml, EscapesNames) {
  const std::string kml = FormatKml({{"a<b", {{42.5, -83.5, 250}}}}, "t&t");
  EXPECT_NE(kml.find("<name>a&lt;b</name>"), std::string::npos);
  EXPECT_NE(kml.find("<name>t&amp;t</name>"), std::string::npos);
  EXPECT_NE(kml.find("\n-83.5,42.5\n"), std::string::npos);
}

}  // namespace
}  // namespace graticule
