// Same input, same digits.

#include <gtest/gtest.h>

#include <algorithm>

#include "graticule/solver/marginals.hpp"
#include "graticule/solver/solve.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::Numbers;
using testing::Random;
using testing::Se2Loop;
using testing::Se3Loop;

// A loop with chords, so that factorisations have fill-in and sums more than two terms.
Graph Meshed(unsigned poses) {
  Graph graph = Se2Loop(poses, 0.05, 0.1);
  const std::vector<Numbers> truth = testing::Circle(poses);
  for (unsigned i = 0; i < poses; i += 3) {
    const unsigned j = (i * 7 + 5) % poses;
    if (i == j) continue;
    graph.Add(BetweenSe2Factor(Key("pose", i), Key("pose", j),
                               testing::Relative(truth[i], truth[j]),
                               Noise::Sigmas({0.2, 0.2, 0.1}), "loop"));
  }
  graph.SetLosses({LossKind::kHuber, 1.345});
  return graph;
}

SolveOptions With(int threads, LinearSolver solver = LinearSolver::kAutomatic) {
  SolveOptions options;
  options.threads = threads;
  options.linear_solver = solver;
  return options;
}

TEST(Determinism, ThreeRunsAndTwoThreadsGiveTheSameDigits) {
  for (const Graph& graph : {Meshed(400), Se3Loop(100, 0.02, 0.05)}) {
    const Solution first = Solve(graph, With(1));
    EXPECT_EQ(first.report.termination, Termination::kConverged);
    for (const int threads : {1, 1, 2, 2, 2, 3}) {
      const Solution again = Solve(graph, With(threads));
      EXPECT_EQ(again.values.Data(), first.values.Data()) << threads << " threads";
      EXPECT_EQ(again.report.final_objective, first.report.final_objective);
      EXPECT_EQ(again.report.final_cost, first.report.final_cost);
      EXPECT_EQ(again.report.Steps(), first.report.Steps());
    }
  }
}

TEST(Determinism, HoldsForMoreThreadsThanFactors) {
  const Graph graph = Se2Loop(3, 0.05, 0.1);
  EXPECT_EQ(Solve(graph, With(16)).values.Data(), Solve(graph, With(1)).values.Data());
}

Graph InAnotherOrder(const Graph& graph, bool factors_too) {
  Random random(6);
  std::vector<VariableId> variables(graph.VariableCount());
  for (VariableId id = 0; id < variables.size(); ++id) variables[id] = id;
  std::shuffle(variables.begin(), variables.end(), random);
  std::vector<FactorId> factors(graph.FactorCount());
  for (FactorId id = 0; id < factors.size(); ++id) factors[id] = id;
  if (factors_too) std::shuffle(factors.begin(), factors.end(), random);
  Graph shuffled(graph.Types());
  for (const VariableId id : variables)
    shuffled.Add(graph.KeyOf(id), graph.TypeOf(id).name,
                 Numbers(graph.ValueOf(id).begin(), graph.ValueOf(id).end()), graph.IsFixed(id));
  for (const FactorId id : factors) shuffled.Add(graph.FactorRecord(id));
  return shuffled;
}

TEST(Determinism, TheOrderOfAddingVariablesDoesNotShow) {
  const Graph graph = Meshed(300);
  for (const LinearSolver solver :
       {LinearSolver::kAutomatic, LinearSolver::kSparseSchur, LinearSolver::kDenseNormalCholesky}) {
    const Solution expected = Solve(graph, With(1, solver));
    const Solution solution = Solve(InAnotherOrder(graph, false), With(1, solver));
    EXPECT_EQ(solution.report.anchors, expected.report.anchors);
    for (VariableId id = 0; id < graph.VariableCount(); ++id)
      for (unsigned i = 0; i < 3; ++i)
        ASSERT_EQ(solution.values.At(graph.KeyOf(id))[i], expected.values[id][i])
            << graph.KeyOf(id).ToString() << " with solver " << static_cast<int>(solver);
  }
}

TEST(Determinism, TheOrderOfAddingFactorsShowsInTheLastDigitsOnly) {
  const Graph graph = Meshed(300);
  const Solution expected = Solve(graph), solution = Solve(InAnotherOrder(graph, true));
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    for (unsigned i = 0; i < 3; ++i)
      ASSERT_NEAR(solution.values.At(graph.KeyOf(id))[i], expected.values[id][i], 1e-6);
}

TEST(Determinism, HoldsForMarginals) {
  const Graph graph = Meshed(200);
  const Solution solution = Solve(graph);
  const auto first =
      ComputeMarginals(graph, solution.values, {Key("pose:7"), Key("pose:90")}, true);
  for (int i = 0; i < 3; ++i) {
    const auto again =
        ComputeMarginals(graph, solution.values, {Key("pose:7"), Key("pose:90")}, true);
    EXPECT_EQ(std::get<Marginals>(again).Covariance(Key("pose:7"), Key("pose:90")),
              std::get<Marginals>(first).Covariance(Key("pose:7"), Key("pose:90")));
  }
}

}  // namespace
}  // namespace graticule
