#include "graticule/problems/chi_square.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace graticule {
namespace {

TEST(ChiSquare, HasTheQuantilesOfTheTables) {
  // Abramowitz and Stegun, table 26.8.
  EXPECT_NEAR(ChiSquareQuantile(0.99, 1), 6.63490, 1e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 2), 9.21034, 1e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 3), 11.3449, 1e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 6), 16.8119, 1e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.5, 3), 2.36597, 1e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.005, 10), 2.15586, 1e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.95, 100), 124.342, 1e-3);
}

TEST(ChiSquare, OfTwoDegreesIsAnExponential) {
  for (const double x : {1e-6, 0.1, 1.0, 3.9, 4.1, 30.0})
    EXPECT_NEAR(ChiSquareShare(x, 2), -std::expm1(-x / 2), 1e-14) << x;
  EXPECT_EQ(ChiSquareShare(0, 2), 0);
}

TEST(ChiSquare, QuantileAndShareAreInverse) {
  for (const double degrees : {1.0, 2.0, 3.0, 6.0, 21.0})
    for (const double p : {1e-6, 0.01, 0.5, 0.9, 0.99, 0.999999})
      EXPECT_NEAR(ChiSquareShare(ChiSquareQuantile(p, degrees), degrees), p, 1e-12)
          << p << " of " << degrees;
}

}  // namespace
}  // namespace graticule
