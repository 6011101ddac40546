#include "graticule/problems/bundle/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "graticule/factors/builtins.hpp"
#include "residuals.hpp"

namespace graticule {
namespace {

TEST(Ring, HasTheSameDigitsAgain) {
  const SimulatedBundle a = SimulateRing(Builtins()), b = SimulateRing(Builtins());
  EXPECT_EQ(a.truth.Data(), b.truth.Data());
  ASSERT_EQ(a.graph.FactorCount(), b.graph.FactorCount());
  for (FactorId id = 0; id < a.graph.FactorCount(); ++id)
    EXPECT_EQ(a.graph.FactorRecord(id).measurement, b.graph.FactorRecord(id).measurement);
}

TEST(Ring, HasAtItsTruthTheNoiseItSaysItHas) {
  const SimulatedBundle ring = SimulateRing(Builtins());
  double squares = 0, count = 0;
  std::map<VariableId, int> seen;
  for (FactorId id = 0; id < ring.graph.FactorCount(); ++id) {
    ++seen[ring.graph.FactorAt(id).variables[1]];
    for (const double r : testing::Whitened(ring.graph, ring.truth, id)) {
      squares += r * r;
      ++count;
    }
  }
  // Chi-square of `count` draws: deviation sqrt(2 count).
  EXPECT_NEAR(squares, count, 4.5 * std::sqrt(2 * count));
  EXPECT_EQ(seen.size(), 200u);
  for (const auto& [point, times] : seen) EXPECT_GE(times, 2);
}

TEST(Ring, PutsEveryPointInFrontOfTheCamerasAndIntoAnImage) {
  const SimulatedBundle ring = SimulateRing(Builtins());
  for (FactorId id = 0; id < ring.graph.FactorCount(); ++id)
    for (const double pixel : ring.graph.FactorAt(id).measurement)
      EXPECT_LT(std::abs(pixel), 800 * 0.5);
}

}  // namespace
}  // namespace graticule
