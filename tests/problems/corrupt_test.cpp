#include "graticule/problems/pose_graph/corrupt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "graticule/problems/pose_graph/suspects.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/error.hpp"
#include "residuals.hpp"

namespace graticule {
namespace {

Simulated City(int dimension, int robots) {
  CityOptions options;
  options.dimension = dimension;
  options.robots = robots;
  options.poses_per_robot = 300;
  return SimulateCity(Builtins(), options);
}

CorruptOptions Options(double fraction, Corruption kind, std::uint64_t seed = 1) {
  CorruptOptions options;
  options.fraction = fraction;
  options.kind = kind;
  options.seed = seed;
  return options;
}

std::uint64_t Apart(const Graph& graph, FactorId id) {
  const auto ends = graph.FactorAt(id).variables;
  const std::uint64_t a = graph.KeyOf(ends[0]).Number(), b = graph.KeyOf(ends[1]).Number();
  return std::max(a, b) - std::min(a, b);
}

constexpr Corruption kKinds[] = {Corruption::kRandom, Corruption::kGrouped, Corruption::kLocal};

TEST(Corrupt, AddsTheShareAskedForAndChangesNothingElse) {
  for (const int dimension : {2, 3})
    for (const Corruption kind : kKinds)
      for (const double fraction : {0.0, 0.1, 0.6}) {
        const Simulated city = City(dimension, 2);
        const std::size_t closures = ChooseSuspects(city.graph).size();
        const Corrupted bad = AddFalseClosures(city.graph, Options(fraction, kind));
        EXPECT_NEAR(static_cast<double>(bad.outliers.size()),
                    fraction / (1 - fraction) * static_cast<double>(closures), 0.5);
        ASSERT_EQ(bad.graph.FactorCount(), city.graph.FactorCount() + bad.outliers.size());
        EXPECT_EQ(ChooseSuspects(bad.graph).size(), closures + bad.outliers.size());
        EXPECT_EQ(bad.graph.InitialValues().Data(), city.graph.InitialValues().Data());
        for (FactorId id = 0; id < city.graph.FactorCount(); ++id) {
          const Factor was = city.graph.FactorRecord(id), is = bad.graph.FactorRecord(id);
          ASSERT_TRUE(was.keys == is.keys && was.measurement == is.measurement);
        }
        for (std::size_t i = 0; i < bad.outliers.size(); ++i)
          ASSERT_EQ(bad.outliers[i], city.graph.FactorCount() + i);
      }
}

TEST(Corrupt, IsTheSameAgainAndOtherwiseWithAnotherSeed) {
  const Simulated city = City(2, 1);
  for (const Corruption kind : kKinds) {
    const Corrupted a = AddFalseClosures(city.graph, Options(0.3, kind));
    const Corrupted b = AddFalseClosures(city.graph, Options(0.3, kind));
    const Corrupted other = AddFalseClosures(city.graph, Options(0.3, kind, 2));
    std::size_t same = 0;
    for (const FactorId id : a.outliers) {
      ASSERT_EQ(a.graph.FactorRecord(id).keys, b.graph.FactorRecord(id).keys);
      ASSERT_EQ(a.graph.FactorRecord(id).measurement, b.graph.FactorRecord(id).measurement);
      same += a.graph.FactorRecord(id).keys == other.graph.FactorRecord(id).keys;
    }
    EXPECT_LT(same, a.outliers.size() / 4);
  }
}

TEST(Corrupt, AddsWhatIsWrong) {
  for (const int dimension : {2, 3})
    for (const Corruption kind : kKinds) {
      const Simulated city = City(dimension, 2);
      const Corrupted bad = AddFalseClosures(city.graph, Options(0.4, kind));
      std::size_t right = 0;
      for (const FactorId id : bad.outliers) {
        double chi2 = 0;
        for (const double r : testing::Whitened(bad.graph, city.truth, id)) chi2 += r * r;
        right += chi2 < ChiSquareQuantile(0.99, bad.graph.ResidualSize(id));
      }
      // By chance the poses of a city of square blocks are as a closure says.
      EXPECT_LE(right, bad.outliers.size() / 50);
    }
}

TEST(Corrupt, JoinsNoTwoPosesTwiceAndKeepsSourcesAndFamilies) {
  const Simulated city = City(2, 2);
  for (const Corruption kind : kKinds) {
    const Corrupted bad = AddFalseClosures(city.graph, Options(0.5, kind));
    std::set<std::pair<VariableId, VariableId>> pairs;
    for (FactorId id = 0; id < bad.graph.FactorCount(); ++id) {
      const FactorView factor = bad.graph.FactorAt(id);
      EXPECT_TRUE(pairs.insert(std::minmax(factor.variables[0], factor.variables[1])).second);
      const bool one_robot = bad.graph.KeyOf(factor.variables[0]).Family() ==
                             bad.graph.KeyOf(factor.variables[1]).Family();
      EXPECT_EQ(factor.source == "inter_robot", !one_robot);
    }
  }
}

TEST(Corrupt, LocalOnesJoinNearPoses) {
  const Simulated city = City(2, 1);
  const Corrupted bad = AddFalseClosures(city.graph, Options(0.3, Corruption::kLocal));
  for (const FactorId id : bad.outliers) {
    EXPECT_GE(Apart(bad.graph, id), 2u);
    EXPECT_LE(Apart(bad.graph, id), 20u);
  }
}

TEST(Corrupt, GroupsAgreeWithTheOdometryBetweenThem) {
  const Simulated city = City(2, 1);
  const Corrupted bad = AddFalseClosures(city.graph, Options(0.3, Corruption::kGrouped));
  // By the odometry, from pose i to i + 1.
  std::vector<std::vector<double>> step(300);
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id)
    if (city.graph.FactorAt(id).source == "odometry")
      step[city.graph.FactorRecord(id).keys[0].Number()] = city.graph.FactorRecord(id).measurement;
  std::size_t neighbours = 0;
  for (std::size_t i = 1; i < bad.outliers.size(); ++i) {
    const Factor a = bad.graph.FactorRecord(bad.outliers[i - 1]);
    const Factor b = bad.graph.FactorRecord(bad.outliers[i]);
    if (a.keys[0].Number() + 1 != b.keys[0].Number() ||
        a.keys[1].Number() + 1 != b.keys[1].Number())
      continue;
    ++neighbours;
    double one_way[7], other_way[7], apart[7];
    Compose(true, a.measurement.data(), step[a.keys[1].Number()].data(), one_way);
    Compose(true, step[a.keys[0].Number()].data(), b.measurement.data(), other_way);
    Between(true, one_way, other_way, apart);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(apart[k], 0, 1e-9);
  }
  EXPECT_GT(neighbours, bad.outliers.size() / 2);
}

TEST(Corrupt, RefusesWhatMakesNoSense) {
  const Simulated city = City(2, 1);
  for (const double fraction : {-0.1, 1.0, std::nan("")})
    EXPECT_THROW(AddFalseClosures(city.graph, Options(fraction, Corruption::kRandom)), Error);
  CityOptions none;
  none.robots = 1;
  none.poses_per_robot = 20;
  none.loops_per_pose = 0;
  EXPECT_THROW(AddFalseClosures(SimulateCity(Builtins(), none).graph), Error);
  // Of few poses all pairs are soon joined.
  EXPECT_THROW(AddFalseClosures(city.graph, Options(0.9999, Corruption::kLocal)), Error);
}

}  // namespace
}  // namespace graticule
