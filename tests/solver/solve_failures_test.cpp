// What Solve refuses, and how a solve ends that does not converge.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "expect_error.hpp"
#include "graticule/solver/solve.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Se2Loop;
using testing::TestTypes;

Graph TwoPieces() {
  Graph graph = Se2Loop(4, 0.01, 0.1);
  graph.Add(Key("other:0"), "se2/1", {0, 0, 0});
  graph.Add(Key("other:1"), "se2/1", {1, 0, 0});
  graph.Add(BetweenSe2Factor(Key("other:0"), Key("other:1"), {2, 0, 0}, Noise::Sigma(0.1)));
  return graph;
}

SolveOptions AllowPieces() {
  SolveOptions options;
  options.allow_pieces = true;
  return options;
}

TEST(Solve, RefusesAGraphInPieces) {
  ExpectError(ErrorKind::kIllPosed, {"2 pieces", "other:0", "pose:0", "allow_pieces"},
              [] { Solve(TwoPieces()); });
}

TEST(Solve, AnchorsEachPieceWhereThatIsAllowed) {
  const Solution solution = Solve(TwoPieces(), AllowPieces());
  EXPECT_EQ(solution.report.termination, Termination::kConverged);
  EXPECT_EQ(solution.report.anchors, (std::vector<std::string>{"other:0", "pose:0"}));
  EXPECT_NEAR(solution.values.At(Key("other:1"))[0], 2, 1e-9);
}

TEST(Solve, TakesPiecesThatAreAllHeld) {
  Graph graph = TwoPieces();
  graph.SetFixed(graph.IdOf(Key("pose:0")), true);
  ExpectError(ErrorKind::kIllPosed, {"other:0"}, [&] { Solve(graph); });
  graph.Add(PriorSe2Factor(Key("other:1"), {0, 0, 0}, Noise::Sigma(0.1)));
  EXPECT_EQ(Solve(graph).report.termination, Termination::kConverged);
}

TEST(Solve, RefusesAVariableThatNoFactorTouches) {
  Graph graph = Se2Loop(4, 0.01, 0.1);
  graph.Add(Key("lonely:5"), "point2/1", {3, 4});
  ExpectError(ErrorKind::kIllPosed, {"no factor touches lonely:5"}, [&] { Solve(graph); });
  const Solution solution = Solve(graph, AllowPieces());
  EXPECT_EQ(solution.values.At(Key("lonely:5"))[0], 3);
  graph.SetFixed(graph.IdOf(Key("lonely:5")), true);
  EXPECT_NO_THROW(Solve(graph)) << "a fixed variable needs no factor";
}

TEST(Solve, RefusesTypesThatAreNotLoadedAndCountsTheirFactors) {
  Graph graph = Se2Loop(4, 0.01, 0.1);
  graph.DeclareFactorType("radar_doppler/1", "pose:se2/1 | rate:m/s");
  graph.DeclareFactorType("sonar/3", "pose:se2/1 | depth:m");
  for (unsigned i = 0; i < 3; ++i)
    graph.Add({"radar_doppler/1", {Key("pose", i)}, {1}, Noise::Unit(), {}, ""});
  graph.Add({"sonar/3", {Key("pose:0")}, {1}, Noise::Unit(), {}, ""});
  ExpectError(ErrorKind::kMissingType,
              {"radar_doppler/1 is not loaded; 3 factors need it",
               "sonar/3 is not loaded; 1 factor needs it"},
              [&] { Solve(graph); });
}

TEST(Solve, RefusesAVariableTypeThatIsNotLoaded) {
  Graph graph = Se2Loop(4, 0.01, 0.1);
  graph.DeclareVariableType("spline/1", "a b");
  graph.Add(Key("spline:0"), "spline/1", {1, 2});
  ExpectError(ErrorKind::kMissingType, {"spline/1 is not loaded", "spline:0"},
              [&] { Solve(graph, AllowPieces()); });
}

TEST(Solve, WarnsOfVariablesWithTooFewResiduals) {
  Graph graph = Se2Loop(4, 0.01, 0.1);
  graph.Add(Key("landmark:3"), "point2/1", {3, 4});
  graph.Add(
      {"bearing_se2/1", {Key("pose:1"), Key("landmark:3")}, {0.5}, Noise::Sigma(0.1), {}, ""});
  const Report report = Solve(graph).report;
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("landmark:3"), std::string::npos) << report.warnings[0];
}

// --- endings

TEST(Solve, NamesTheFactorThatCannotBeEvaluated) {
  for (const int threads : {1, 2}) {
    Graph graph(TestTypes());
    for (unsigned i = 0; i < 4; ++i) graph.Add(Key("x", i), "vector1/1", {i < 2 ? 5.0 : 0.0});
    for (unsigned i = 0; i < 4; ++i)
      graph.Add({"limited/1", {Key("x", i)}, {7, 1}, Noise::Unit(), {}, ""});
    SolveOptions options;
    options.threads = threads;
    const Solution solution = Solve(graph, options);
    EXPECT_EQ(solution.report.termination, Termination::kFailed);
    EXPECT_NE(solution.report.message.find("factor 2 limited/1 (x:2)"), std::string::npos)
        << solution.report.message;
    EXPECT_EQ(solution.values.Data(), graph.InitialValues().Data());
    EXPECT_TRUE(std::isnan(solution.report.initial_objective));
    EXPECT_TRUE(std::isnan(solution.report.final_objective));
    EXPECT_EQ(solution.report.worst[0].id, 2u) << "what cannot be evaluated is worst";
  }
}

TEST(Solve, ShortensAStepIntoWhereAFactorCannotBeEvaluated) {
  // log(x) = 0 from x = 10: the full step goes to -13.
  Graph graph(TestTypes());
  graph.Add(Key("x:0"), "vector1/1", {10});
  graph.Add({"log/1", {Key("x:0")}, {0}, Noise::Unit(), {}, ""});
  for (const int threads : {1, 2}) {
    SolveOptions options;
    options.threads = threads;
    const Solution solution = Solve(graph, options);
    EXPECT_EQ(solution.report.termination, Termination::kConverged) << solution.report.message;
    EXPECT_NEAR(solution.values.At(Key("x:0"))[0], 1, 1e-6);
  }
}

TEST(Solve, ThatGivesUpHalfWayReturnsValuesThatFitItsCosts) {
  // The minimum at -1 lies beyond what can be evaluated: no step can reach it.
  Graph graph(TestTypes());
  graph.Add(Key("x:0"), "vector1/1", {5});
  graph.Add({"limited/1", {Key("x:0")}, {-1, 0.5}, Noise::Unit(), {}, ""});
  const Solution solution = Solve(graph);
  const double cost = 0.5 * FactorChi2(graph, solution.values)[0];
  EXPECT_NEAR(solution.report.final_objective, cost, 1e-12 * cost) << solution.report.message;
  EXPECT_NEAR(solution.report.final_cost, cost, 1e-12 * cost);
}

TEST(Solve, StopsWhenTheObserverSaysSo) {
  const Graph graph = Se2Loop(50, 0.1, 0.3);
  Observer watch;
  watch.on_iteration = [](const Iteration& row) { return row.number < 2; };
  const Solution solution = Solve(graph, {}, watch);
  EXPECT_EQ(solution.report.termination, Termination::kCancelled);
  EXPECT_EQ(solution.report.iterations.size(), 3u);
  double best = 0;
  for (const double chi2 : FactorChi2(graph, solution.values)) best += 0.5 * chi2;
  EXPECT_NEAR(best, solution.report.final_objective, 1e-9 * best) << "the best values so far";
  EXPECT_LT(best, solution.report.initial_objective);
}

TEST(Solve, LetsAnExceptionOfTheObserverThrough) {
  const Graph graph = Se2Loop(50, 0.1, 0.3);
  Observer watch;
  watch.on_iteration = [](const Iteration&) -> bool { throw std::runtime_error("interrupted"); };
  EXPECT_THROW(Solve(graph, {}, watch), std::runtime_error);
  EXPECT_EQ(Solve(graph).report.termination, Termination::kConverged);
}

TEST(Solve, StopsAtItsTimeLimit) {
  const Graph graph = Se2Loop(50, 0.1, 0.3);
  Observer slow;
  slow.on_iteration = [](const Iteration&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    return true;
  };
  SolveOptions options;
  options.time_limit_s = 0.02;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0;
  const Report report = Solve(graph, options, slow).report;
  EXPECT_EQ(report.termination, Termination::kTimeLimit) << report.message;
}

TEST(Solve, StopsAfterSoManyIterations) {
  const Graph graph = Se2Loop(50, 0.1, 0.3);
  SolveOptions options;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0;
  for (const int most : {0, 1, 2}) {
    options.max_iterations = most;
    const Report report = Solve(graph, options).report;
    EXPECT_EQ(report.termination, Termination::kNoConvergence) << report.message;
    EXPECT_EQ(report.Steps(), static_cast<std::size_t>(most));
  }
}

TEST(FactorChi2, RefusesValuesOfAnotherGraph) {
  const Graph graph = Se2Loop(8, 0.1, 0.1);
  const Graph smaller = Se2Loop(4, 0.1, 0.1);
  ExpectError(ErrorKind::kUsage, {"values"}, [&] { FactorChi2(graph, smaller.InitialValues()); });
  ExpectError(ErrorKind::kUsage, {"values"}, [&] { FactorChi2(graph, Values()); });
  Graph grown = graph;
  const Values before = grown.InitialValues();
  grown.Add(Key("pose:100"), "se2/1", {0, 0, 0});
  ExpectError(ErrorKind::kUsage, {"values"}, [&] { FactorChi2(grown, before); });
  const Graph twin = Se2Loop(8, 0.1, 0.1);
  EXPECT_NO_THROW(FactorChi2(graph, twin.InitialValues())) << "the same keys in the same order";
}

TEST(Objectives, AreWhatSolveMinimisesAtEachOfTheValues) {
  Graph graph = Se2Loop(20, 0.1, 0.3);
  graph.SetLosses(MakeLoss("huber", 0.5));
  const Solution solution = Solve(graph);
  const Values before = graph.InitialValues();
  const std::vector<double> objectives = Objectives(graph, {&before, &solution.values, &before});
  ASSERT_EQ(objectives.size(), 3u);
  const Report& report = solution.report;
  EXPECT_NEAR(objectives[0], report.initial_objective, 1e-12 * objectives[0]);
  EXPECT_NEAR(objectives[1], report.final_objective, 1e-12 * objectives[1]);
  EXPECT_EQ(objectives[2], objectives[0]);
  EXPECT_LT(report.initial_objective, report.initial_cost);  // the loss counts
  const Values other = Se2Loop(4, 0.1, 0.1).InitialValues();
  ExpectError(ErrorKind::kUsage, {"values"}, [&] { Objectives(graph, {&before, &other}); });
}

}  // namespace
}  // namespace graticule
