#include "graticule/problems/mapping/georeference.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

const Geodetic kAnnArbor{42.293, -83.711, 260};

TEST(Georeference, GoesThereAndBack) {
  for (const double x : {-4000.0, 0.0, 123.456}) {
    const Geodetic place = GeodeticOf(kAnnArbor, x, 2 * x - 7);
    double back_x = 0, back_y = 0;
    MapPointOf(kAnnArbor, place, &back_x, &back_y);
    EXPECT_NEAR(back_x, x, 1e-8);
    EXPECT_NEAR(back_y, 2 * x - 7, 1e-8);
    EXPECT_EQ(place.height, 260);
  }
}

// Against the radii of curvature of the ellipsoid, at the datum's height.
TEST(Georeference, AgreesWithTheRadiiOfTheEarth) {
  constexpr double kA = 6378137, kE2 = 0.00669437999014;
  const double latitude = kAnnArbor.latitude * M_PI / 180;
  const double root = std::sqrt(1 - kE2 * std::sin(latitude) * std::sin(latitude));
  const double meridian = kA * (1 - kE2) / (root * root * root), normal = kA / root;
  const Geodetic north = GeodeticOf(kAnnArbor, 0, 100), east = GeodeticOf(kAnnArbor, 100, 0);
  EXPECT_NEAR((north.latitude - kAnnArbor.latitude) * M_PI / 180 * (meridian + 260), 100, 1e-4);
  EXPECT_NEAR(north.longitude, kAnnArbor.longitude, 1e-12);
  EXPECT_NEAR(
      (east.longitude - kAnnArbor.longitude) * M_PI / 180 * (normal + 260) * std::cos(latitude),
      100, 1e-4);
}

TEST(Georeference, ReadsADatum) {
  const Geodetic datum = ParseDatum("42.293,-83.711,260");
  EXPECT_EQ(datum.latitude, 42.293);
  EXPECT_EQ(datum.longitude, -83.711);
  EXPECT_EQ(datum.height, 260);
  EXPECT_EQ(ParseDatum("-1,2").height, 0);
  for (const char* bad :
       {"", "1", "1,", "1,2,", "1,2,3,4", "95,0", "0,181", "a,b", "nan,0", "1 ,2"})
    EXPECT_THROW(ParseDatum(bad), Error) << bad;
}

}  // namespace
}  // namespace graticule
