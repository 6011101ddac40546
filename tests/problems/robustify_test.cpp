#include "graticule/problems/pose_graph/robustify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../solver/expect_error.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/pose_graph/consistency.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "graticule/problems/pose_graph/suspects.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

Simulated City(int dimension, int robots, double outliers, std::uint64_t seed = 1) {
  CityOptions options;
  options.dimension = dimension;
  options.robots = robots;
  options.poses_per_robot = 600 / robots;
  options.outlier_fraction = outliers;
  options.seed = seed;
  return SimulateCity(Builtins(), options);
}

RejectionOptions By(Rejection method) {
  RejectionOptions options;
  options.reject_outliers = method;
  return options;
}

struct Score {
  double recall, precision;
};

template <class Ids>
Score ScoreOf(const Simulated& city, const Ids& rejected) {
  double found = 0;
  for (const FactorId id : rejected)
    found += std::binary_search(city.outliers.begin(), city.outliers.end(), id);
  return {found / static_cast<double>(city.outliers.size()),
          found / static_cast<double>(rejected.size())};
}

Score ScoreOf(const Simulated& city, const RobustSolution& robust) {
  std::vector<FactorId> rejected;
  for (const auto& factor : robust.rejection.rejected) rejected.push_back(factor.id);
  return ScoreOf(city, rejected);
}

// Root mean square distance of the positions, as they are: the city's first pose is fixed.
double Error(const Graph& graph, const Values& a, const Values& b) {
  double sum = 0;
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    sum += std::pow(a[id][0] - b[id][0], 2) + std::pow(a[id][1] - b[id][1], 2);
  return std::sqrt(sum / static_cast<double>(graph.VariableCount()));
}

// What the solver finds where nothing is wrong to begin with.
Values SolvedWithoutTheOutliers(const Simulated& city) {
  Graph clean(Builtins());
  for (VariableId id = 0; id < city.graph.VariableCount(); ++id)
    clean.Add(city.graph.KeyOf(id), city.graph.TypeOf(id).name,
              {city.graph.ValueOf(id).begin(), city.graph.ValueOf(id).end()},
              city.graph.IsFixed(id));
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id)
    if (!std::binary_search(city.outliers.begin(), city.outliers.end(), id))
      clean.Add(city.graph.FactorRecord(id));
  Initialise(&clean, InitialGuess::kChordal, true);
  return Solve(clean).values;
}

struct World {
  int dimension, robots;
  double outliers;
};

void PrintTo(const World& world, std::ostream* out) {
  *out << world.robots << " robots in " << world.dimension << "D, " << world.outliers;
}

class Robustify : public ::testing::TestWithParam<World> {};

// The quantile is 0.99: one in a hundred true closures is beyond it, so the precision of many
// closures with few outliers is the lower one.
TEST_P(Robustify, FindsTheFalseClosuresOfACity) {
  const auto [dimension, robots, outliers] = GetParam();
  const Simulated city = City(dimension, robots, outliers);
  const RobustSolution robust = SolveWithoutOutliers(city.graph, By(Rejection::kGncTls));
  const Score score = ScoreOf(city, robust);
  EXPECT_GE(score.recall, 0.98);
  EXPECT_GE(score.precision, outliers < 0.2 ? 0.85 : 0.95);
  EXPECT_EQ(robust.rejection.suspects, ChooseSuspects(city.graph));
  EXPECT_EQ(robust.rejection.factors, city.graph.FactorCount());
  EXPECT_EQ(robust.solution.report.factors,
            city.graph.FactorCount() - robust.rejection.rejected.size());
  // Odometry of 0.05 m a step leaves the optimum itself off the truth by more.
  EXPECT_LT(Error(city.graph, robust.solution.values, SolvedWithoutTheOutliers(city)), 0.1);
  EXPECT_NEAR(robust.solution.report.ReducedChi2(), 1, 0.15);
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id) {
    const bool is_rejected =
        std::any_of(robust.rejection.rejected.begin(), robust.rejection.rejected.end(),
                    [id](const auto& factor) { return factor.id == id; });
    ASSERT_NE(robust.is_kept[id], is_rejected);
  }
}

INSTANTIATE_TEST_SUITE_P(Cities, Robustify,
                         ::testing::Values(World{2, 1, 0.1}, World{2, 1, 0.5}, World{2, 3, 0.3},
                                           World{2, 3, 0.6}, World{3, 1, 0.3}, World{3, 2, 0.5}));

TEST(Rejection, ByGemanMcClureFindsThemToo) {
  const Simulated city = City(2, 1, 0.3);
  const Score score = ScoreOf(city, SolveWithoutOutliers(city.graph, By(Rejection::kGncGm)));
  EXPECT_GE(score.recall, 0.98);
  EXPECT_GE(score.precision, 0.9);
}

TEST(Rejection, ByPairwiseConsistencyFindsMost) {
  for (const int dimension : {2, 3}) {
    const Simulated city = City(dimension, 3, 0.4);
    const RobustSolution robust = SolveWithoutOutliers(city.graph, By(Rejection::kPcm));
    const Score score = ScoreOf(city, robust);
    EXPECT_GE(score.recall, 0.95) << dimension;
    EXPECT_GE(score.precision, 0.85) << dimension;
    EXPECT_EQ(robust.rejection.trees, 3u);
    EXPECT_EQ(robust.rejection.groups, 6u) << "three within, three between";
    EXPECT_EQ(robust.rejection.unchecked, 0u);
  }
}

TEST(Rejection, OfClosuresBetweenRobotsOnlyLeavesTheOthersAlone) {
  const Simulated city = City(2, 3, 0.4);
  const std::vector<FactorId> suspects = ChooseSuspects(city.graph);
  ConsistencyOptions options;
  options.only_between_trees = true;
  const ConsistencyResult result = FindConsistent(city.graph, suspects, options);
  std::vector<FactorId> rejected;
  for (std::size_t i = 0; i < suspects.size(); ++i)
    if (!result.is_kept[i]) rejected.push_back(suspects[i]);
  EXPECT_EQ(result.groups, 3u);
  double wrong_between = 0, found = 0;
  for (const FactorId id : city.outliers)
    wrong_between += city.graph.FactorAt(id).source == "inter_robot";
  for (const FactorId id : rejected) {
    EXPECT_EQ(city.graph.FactorAt(id).source, "inter_robot");
    found += std::binary_search(city.outliers.begin(), city.outliers.end(), id);
  }
  EXPECT_GE(found, 0.95 * wrong_between);
  EXPECT_GE(found, 0.85 * static_cast<double>(rejected.size()));
}

TEST(Rejection, OfNothingWrongKeepsAlmostEverything) {
  const Simulated city = City(2, 2, 0);
  const RobustSolution robust = SolveWithoutOutliers(city.graph, By(Rejection::kGncTls));
  // One in a hundred is expected beyond the quantile.
  EXPECT_LE(robust.rejection.rejected.size(), robust.rejection.suspects.size() / 40);
}

TEST(Rejection, HasTheSameDigitsAgain) {
  const Simulated city = City(2, 2, 0.4);
  for (const Rejection method : {Rejection::kGncTls, Rejection::kPcm}) {
    const RobustSolution a = SolveWithoutOutliers(city.graph, By(method));
    const RobustSolution b = SolveWithoutOutliers(city.graph, By(method));
    EXPECT_EQ(a.solution.values.Data(), b.solution.values.Data());
    EXPECT_EQ(a.is_kept, b.is_kept);
  }
}

TEST(Rejection, DoesNotMindWhereTheGraphsValuesAre) {
  const Simulated city = City(2, 2, 0.4);
  Graph moved = city.graph;
  for (VariableId id = 0; id < moved.VariableCount(); ++id)
    if (!moved.IsFixed(id)) moved.SetValue(id, std::vector<double>{1000.0 + id, -5, 2});
  EXPECT_EQ(SolveWithoutOutliers(moved, By(Rejection::kGncTls)).is_kept,
            SolveWithoutOutliers(city.graph, By(Rejection::kGncTls)).is_kept);
}

// The city with noise that is said to be so many times what it is.
Graph Overestimated(const Simulated& city, double times) {
  Graph graph(Builtins());
  for (VariableId id = 0; id < city.graph.VariableCount(); ++id)
    graph.Add(city.graph.KeyOf(id), "se2/1",
              {city.graph.ValueOf(id).begin(), city.graph.ValueOf(id).end()},
              city.graph.IsFixed(id));
  for (FactorId id = 0; id < city.graph.FactorCount(); ++id) {
    Factor factor = city.graph.FactorRecord(id);
    for (double& sigma : factor.noise.values) sigma *= times;
    graph.Add(factor);
  }
  return graph;
}

// False closures that are not far off pass, unless the scale adapts.
TEST(Rejection, AdaptsToNoiseThatIsOverestimated) {
  const Simulated city = City(2, 1, 0.3);
  const Graph graph = Overestimated(city, 20);
  RejectionOptions options = By(Rejection::kGncTls);
  const RobustSolution as_said = SolveWithoutOutliers(graph, options);
  EXPECT_EQ(as_said.rejection.inlier_noise_scale, 1);
  options.inlier_noise_scale = 0;
  const RobustSolution adapted = SolveWithoutOutliers(graph, options);
  EXPECT_NEAR(adapted.rejection.inlier_noise_scale, 0.05, 0.02);
  EXPECT_GE(ScoreOf(city, adapted).recall, 0.98);
  EXPECT_LT(ScoreOf(city, as_said).recall, ScoreOf(city, adapted).recall - 0.05);
}

TEST(Rejection, WarnsWhereWrongFactorsMayPass) {
  const Graph graph = Overestimated(City(2, 1, 0), 20);
  const auto warnings = SolveWithoutOutliers(graph, By(Rejection::kGncTls)).rejection.warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("inlier_noise_scale=automatic"), std::string::npos);
}

// Not a pose graph: a point, some that say where it is, and some that do not.
TEST(Rejection, WorksOnAnyGraphWhereSourcesAreNamed) {
  Graph graph(Builtins());
  const Key point("point:0");
  graph.Add(point, "point2/1", {50, 50});
  const auto say = [&](double x, double y, const char* source) {
    graph.Add(Factor{"prior_point2/1", {point}, {x, y}, Noise::Sigma(0.1), {}, source});
  };
  say(1.3, 2.2, "map");
  for (int i = 0; i < 6; ++i) say(1 + 0.05 * i, 2 - 0.04 * i, "fix");
  for (int i = 0; i < 5; ++i) say(9 + i * i, -20 + 3 * i, "fix");
  ExpectError(ErrorKind::kUsage, {"no factor is suspect", "suspect_sources"},
              [&] { SolveWithoutOutliers(graph, By(Rejection::kGncTls)); });
  RejectionOptions options = By(Rejection::kGncTls);
  options.suspect_sources = "fix";
  for (const Rejection method : {Rejection::kGncTls, Rejection::kGncGm}) {
    options.reject_outliers = method;
    const RobustSolution robust = SolveWithoutOutliers(graph, options);
    ASSERT_EQ(robust.rejection.rejected.size(), 5u);
    EXPECT_EQ(robust.rejection.rejected[0].id, 7u);
    const auto found = robust.solution.values[0];
    EXPECT_NEAR(found[0], (1.3 + 6 * 1 + 0.05 * 15) / 7, 1e-9);
    EXPECT_NEAR(found[1], (2.2 + 6 * 2 - 0.04 * 15) / 7, 1e-9);
  }
}

// Two robots, and what joins them is rejected: by a closure of the first that cannot be.
TEST(Rejection, SaysSoWhereTheGraphFallsApart) {
  CityOptions options;
  options.robots = 2;
  options.poses_per_robot = 30;
  options.inter_robot_per_pose = 0;
  options.loops_per_pose = 0;
  Graph graph = SimulateCity(Builtins(), options).graph;
  const auto join = [&](const char* a, const char* b, double x, const char* source) {
    graph.Add(Factor{"between_se2/1", {Key(a), Key(b)}, {x, 0, 0}, Noise::Sigma(0.01), {}, source});
  };
  join("robot1:5", "robot2:5", 0, "meeting");
  // One closure between two robots contradicts nothing.
  EXPECT_TRUE(SolveWithoutOutliers(graph, By(Rejection::kGncTls)).rejection.rejected.empty());
  RejectionOptions rejection = By(Rejection::kGncTls);
  rejection.trusted_sources = "meeting";
  ExpectError(ErrorKind::kUsage, {"no factor is suspect"},
              [&] { SolveWithoutOutliers(graph, rejection); });
  // Two that contradict each other, and a limit that neither meets half way.
  join("robot1:5", "robot2:5", 50, "meeting");
  rejection.trusted_sources.clear();
  const auto rejected = SolveWithoutOutliers(graph, rejection).rejection.rejected;
  EXPECT_EQ(rejected.size(), 1u);
}

TEST(Rejection, EndsWhereTheObserverSaysSo) {
  const Simulated city = City(2, 1, 0.4);
  int calls = 0;
  const Observer watch{[&](const Iteration&) { return ++calls < 3; }};
  const RobustSolution robust =
      SolveWithoutOutliers(city.graph, By(Rejection::kGncTls), SolveOptions(), watch);
  EXPECT_EQ(robust.solution.report.termination, Termination::kCancelled);
  EXPECT_LE(calls, 4);
}

TEST(Rejection, OptionsAreReadAndShown) {
  RejectionOptions options;
  const auto& table = RejectionOptionTable();
  for (const auto& [name, value] :
       {std::pair("reject_outliers", "pcm"), std::pair("inlier_quantile", "0.95"),
        std::pair("inlier_noise_scale", "automatic"), std::pair("suspect_sources", "a,b")}) {
    SetOption(table, name, value, &options);
    const auto row = std::find_if(table.begin(), table.end(),
                                  [name = name](const auto& entry) { return entry.name == name; });
    EXPECT_EQ(row->get(options), value);
  }
  for (const auto& [name, value] :
       {std::pair("inlier_quantile", "1"), std::pair("inlier_noise_scale", "0"),
        std::pair("reject_outliers", "gnc")})
    ExpectError(ErrorKind::kUsage, {name, value},
                [&, name = name, value = value] { SetOption(table, name, value, &options); });
}

}  // namespace
}  // namespace graticule
