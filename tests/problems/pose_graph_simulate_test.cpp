#include "graticule/problems/pose_graph/simulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "graticule/factors/builtins.hpp"
#include "graticule/solver/error.hpp"
#include "residuals.hpp"

namespace graticule {
namespace {

CityOptions SmallCity(int dimension) {
  CityOptions options;
  options.dimension = dimension;
  options.robots = 3;
  options.poses_per_robot = 400;
  options.landmarks = 50;
  return options;
}

std::map<std::string, std::size_t> CountSources(const Graph& graph) {
  std::map<std::string, std::size_t> count;
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    ++count[std::string(graph.FactorAt(id).source)];
  return count;
}

class City : public ::testing::TestWithParam<int> {};

TEST_P(City, HasTheSameDigitsAgain) {
  const CityOptions options = SmallCity(GetParam());
  const Simulated a = SimulateCity(Builtins(), options), b = SimulateCity(Builtins(), options);
  EXPECT_EQ(a.truth.Data(), b.truth.Data());
  EXPECT_EQ(a.graph.InitialValues().Data(), b.graph.InitialValues().Data());
  ASSERT_EQ(a.graph.FactorCount(), b.graph.FactorCount());
  for (FactorId id = 0; id < a.graph.FactorCount(); ++id)
    EXPECT_EQ(a.graph.FactorRecord(id).measurement, b.graph.FactorRecord(id).measurement);
  CityOptions other = options;
  other.seed = 2;
  EXPECT_NE(SimulateCity(Builtins(), other).truth.Data(), a.truth.Data());
}

TEST_P(City, DrivesTheSameRoutesWhateverTheNoise) {
  CityOptions options = SmallCity(GetParam());
  const Simulated a = SimulateCity(Builtins(), options);
  options.odometry_sigma_m *= 10;
  options.loops_per_pose = 0;
  EXPECT_EQ(SimulateCity(Builtins(), options).truth.Data(), a.truth.Data());
}

TEST_P(City, HasTheCountsAskedFor) {
  const CityOptions options = SmallCity(GetParam());
  const Simulated city = SimulateCity(Builtins(), options);
  EXPECT_EQ(city.graph.VariableCount(), 3u * 400 + 50);
  const auto count = CountSources(city.graph);
  EXPECT_EQ(count.at("odometry"), 3u * 399);
  EXPECT_EQ(count.at("loop"), 600u);         // 0.5 a pose
  EXPECT_EQ(count.at("inter_robot"), 240u);  // 0.2 a pose
  EXPECT_GE(count.at("sighting"), 50u);
  EXPECT_TRUE(city.outliers.empty());

  std::size_t fixed = 0;
  for (VariableId id = 0; id < city.graph.VariableCount(); ++id) fixed += city.graph.IsFixed(id);
  EXPECT_EQ(fixed, 1u);
  const VariableId first = city.graph.IdOf(Key("robot1:0"));
  EXPECT_TRUE(city.graph.IsFixed(first));
  for (std::size_t i = 0; i < city.truth[first].size(); ++i)
    EXPECT_EQ(city.graph.ValueOf(first)[i], city.truth[first][i]);

  std::set<VariableId> seen;
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id)
    if (city.graph.FactorAt(id).source == "sighting")
      seen.insert(city.graph.FactorAt(id).variables[1]);
  EXPECT_EQ(seen.size(), 50u) << "every landmark is seen at least once";
}

TEST_P(City, HasAtItsTruthTheNoiseItSaysItHas) {
  CityOptions options = SmallCity(GetParam());
  options.poses_per_robot = 1500;
  const Simulated city = SimulateCity(Builtins(), options);
  struct Sum {
    double squares = 0, values = 0;
    double count = 0;
  };
  std::map<std::pair<std::string, std::size_t>, Sum> sums;
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id) {
    const auto whitened = testing::Whitened(city.graph, city.truth, id);
    for (std::size_t i = 0; i < whitened.size(); ++i) {
      Sum& sum = sums[{std::string(city.graph.FactorAt(id).source), i}];
      sum.squares += whitened[i] * whitened[i];
      sum.values += whitened[i];
      ++sum.count;
    }
  }
  for (const auto& [name, sum] : sums) {
    SCOPED_TRACE(name.first + " " + std::to_string(name.second));
    // Of n draws from N(0, 1): the sum has deviation sqrt(n), the sum of squares sqrt(2n); 4.5 of
    // them are passed once in 150000 tries.
    EXPECT_GT(sum.count, 100);
    EXPECT_NEAR(sum.squares, sum.count, 4.5 * std::sqrt(2 * sum.count));
    EXPECT_NEAR(sum.values, 0, 4.5 * std::sqrt(sum.count));
  }
}

TEST_P(City, JoinsOnlyPosesThatWereNearAndFarApartInTime) {
  const CityOptions options = SmallCity(GetParam());
  const Simulated city = SimulateCity(Builtins(), options);
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id) {
    const FactorView factor = city.graph.FactorAt(id);
    if (factor.source != "loop" && factor.source != "inter_robot") continue;
    const Key& a = city.graph.KeyOf(factor.variables[0]);
    const Key& b = city.graph.KeyOf(factor.variables[1]);
    const auto x = city.truth.At(a), y = city.truth.At(b);
    EXPECT_LE(std::hypot(x[0] - y[0], x[1] - y[1]), options.closure_range_m);
    EXPECT_EQ(a.Family() == b.Family(), factor.source == "loop");
    if (factor.source == "loop") {
      EXPECT_GE(b.Number(), a.Number() + 50);
    }
  }
}

TEST_P(City, SaysWhichClosuresAreWrongButNotInTheGraph) {
  CityOptions options = SmallCity(GetParam());
  options.outlier_fraction = 0.3;
  const Simulated city = SimulateCity(Builtins(), options);
  const auto count = CountSources(city.graph);
  const auto closures = static_cast<double>(count.at("loop") + count.at("inter_robot"));
  EXPECT_EQ(count.count("outlier"), 0u);
  EXPECT_NEAR(static_cast<double>(city.outliers.size()), 0.3 * closures,
              4.5 * std::sqrt(0.21 * closures));
  const std::set<FactorId> wrong(city.outliers.begin(), city.outliers.end());
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id) {
    double worst = 0;
    for (const double r : testing::Whitened(city.graph, city.truth, id))
      worst = std::max(worst, std::abs(r));
    if (wrong.count(id) == 0) {
      EXPECT_LT(worst, 6) << id;  // passed once in 5e8 numbers
    }
  }
}

TEST_P(City, HasNoPairTwiceAndStopsWhereThereAreNoMore) {
  CityOptions options;
  options.dimension = GetParam();
  options.robots = 2;
  options.poses_per_robot = 60;
  options.loops_per_pose = options.inter_robot_per_pose = 1000;
  const Simulated city = SimulateCity(Builtins(), options);
  std::set<std::pair<VariableId, VariableId>> pairs;
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id) {
    const auto ends = city.graph.FactorAt(id).variables;
    EXPECT_TRUE(pairs.insert({ends[0], ends[1]}).second);
  }
}

TEST_P(City, HasOnePoseAndNothingElseIfAsked) {
  CityOptions options;
  options.dimension = GetParam();
  options.robots = options.poses_per_robot = 1;
  const Simulated city = SimulateCity(Builtins(), options);
  EXPECT_EQ(city.graph.VariableCount(), 1u);
  EXPECT_EQ(city.graph.FactorCount(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Dimension, City, ::testing::Values(2, 3));

TEST(City, StaysOnItsStreetsAndOnTheGround) {
  CityOptions options = SmallCity(3);
  options.blocks = 3;
  const Simulated city = SimulateCity(Builtins(), options);
  double steepest = 0;
  for (VariableId id = 0; id < 1200; ++id) {
    const auto pose = city.truth[id];
    EXPECT_TRUE(std::fmod(pose[0], 20) == 0 || std::fmod(pose[1], 20) == 0);
    EXPECT_TRUE(pose[0] >= 0 && pose[0] <= 60 && pose[1] >= 0 && pose[1] <= 60);
    // The third column of the rotation: the body's z axis; how far from upright.
    const double up = 1 - 2 * (pose[3] * pose[3] + pose[4] * pose[4]);
    steepest = std::max(steepest, std::acos(up));
  }
  EXPECT_GT(steepest, 0.02);
  EXPECT_LT(steepest, 0.2);
}

TEST(City, RefusesOptionsThatMakeNoSense) {
  CityOptions options;
  options.dimension = 4;
  EXPECT_THROW(SimulateCity(Builtins(), options), Error);
  options = CityOptions();
  options.odometry_sigma_m = 0;
  EXPECT_THROW(SimulateCity(Builtins(), options), Error);
}

}  // namespace
}  // namespace graticule
