// Our own minimiser against Ceres, which knows nothing of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "expect_error.hpp"
#include "graticule/solver/solve.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Se2Loop;
using testing::Se3Loop;

SolveOptions To(Engine engine) {
  SolveOptions options;
  options.engine = engine;
  options.function_tolerance = 1e-15;
  options.max_iterations = 200;
  return options;
}

// To the last digits, so that where it stops does not blur where it goes.
void ExpectAgreement(const Graph& graph, SolveOptions (*to)(Engine) = To) {
  const Solution ceres = Solve(graph, to(Engine::kCeres));
  const Solution direct = Solve(graph, to(Engine::kDirect));
  EXPECT_EQ(direct.report.termination, Termination::kConverged) << direct.report.message;
  EXPECT_EQ(direct.report.linear_solver.find("block_normal_cholesky ("), 0u);
  EXPECT_NEAR(direct.report.final_objective, ceres.report.final_objective,
              1e-9 * ceres.report.final_objective + 1e-20);
  EXPECT_EQ(direct.report.parameters, ceres.report.parameters);
  EXPECT_EQ(direct.report.initial_objective, direct.report.iterations.front().objective);
  EXPECT_EQ(direct.report.final_objective, direct.report.iterations.back().objective);
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    for (std::size_t i = 0; i < ceres.values[id].size(); ++i)
      EXPECT_NEAR(direct.values[id][i], ceres.values[id][i], 1e-5) << graph.KeyOf(id).ToString();
}

TEST(DirectMinimiser, AgreesWithCeresOnLoops) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectAgreement(Se2Loop(60, 0.05, 0.2, seed));
    ExpectAgreement(Se3Loop(40, 0.05, 0.1, seed));
  }
}

TEST(DirectMinimiser, AgreesWithCeresUnderEveryLoss) {
  for (const std::string_view name : LossNames()) {
    SCOPED_TRACE(name);
    Graph graph = Se2Loop(60, 0.02, 0.002);
    std::array<double, 3> wrong = testing::Relative(testing::Circle(60)[3], testing::Circle(60)[9]);
    wrong[0] += 0.6;  // six sigma
    graph.Add(BetweenSe2Factor(Key("pose:3"), Key("pose:9"), wrong, Noise::Sigmas({0.1, 0.1, 0.05}),
                               "wrong"));
    graph.SetLosses(MakeLoss(name, 2));
    ExpectAgreement(graph);
  }
}

TEST(DirectMinimiser, AgreesWithCeresWhereVariablesAreFixedAndBlocksDiffer) {
  Graph graph = Se2Loop(30, 0.05, 0.1);
  graph.SetFixed(graph.IdOf(Key("pose:7")), true);
  for (unsigned i = 0; i < 10; ++i) graph.Add(Key("landmark", i), "point2/1", {1.0 * i, 1});
  for (unsigned i = 0; i < 60; ++i)
    graph.Add(Factor{"landmark_se2/1",
                     {Key("pose", i % 30), Key("landmark", (i * 7) % 10)},
                     {std::cos(1.0 * i), 2 + std::sin(2.0 * i)},
                     Noise::Sigma(0.5),
                     {},
                     ""});
  ExpectAgreement(graph);
  graph.SetFixed(graph.IdOf(Key("landmark:4")), true);
  ExpectAgreement(graph);
}

TEST(DirectMinimiser, AgreesWithCeresWithDampingAndWithout) {
  ExpectAgreement(Se2Loop(60, 0.05, 0.3), [](Engine engine) {
    SolveOptions options = To(engine);
    options.initial_trust_region_radius = 1e4;
    return options;
  });
  ExpectAgreement(Se2Loop(60, 0.05, 0.05), [](Engine engine) {
    SolveOptions options = To(engine);
    options.method = Method::kGaussNewton;
    options.reuse_factorisation = false;
    return options;
  });
}

TEST(DirectMinimiser, ReusesAFactorisationAndSaysSo) {
  const Graph graph = Se2Loop(60, 0.02, 0.02);
  SolveOptions options;
  const Solution with = Solve(graph, options);
  options.reuse_factorisation = false;
  const Solution without = Solve(graph, options);
  const auto reused = [](const Solution& solution) {
    const auto& rows = solution.report.iterations;
    return std::count_if(rows.begin(), rows.end(), [](const auto& r) { return r.reused_factor; });
  };
  EXPECT_GT(reused(with), 0);
  EXPECT_EQ(reused(without), 0);
  EXPECT_NEAR(with.report.final_objective, without.report.final_objective,
              1e-9 * without.report.final_objective);
}

TEST(DirectMinimiser, GivesTheSameDigitsForEveryNumberOfThreads) {
  Graph graph = Se3Loop(40, 0.05, 0.1);
  SolveOptions options = To(Engine::kDirect);
  const Solution one = Solve(graph, options);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    EXPECT_EQ(Solve(graph, options).values.Data(), one.values.Data()) << threads;
  }
}

TEST(DirectMinimiser, IsRefusedWhatItDoesNotDo) {
  const Graph graph = Se2Loop(10, 0.05, 0.1);
  for (const char* setting : {"method=dogleg", "linear_solver=cgnr", "linear_algebra=eigen_sparse",
                              "nonmonotonic_steps=true"}) {
    SolveOptions options = To(Engine::kDirect);
    const std::string text = setting;
    SetOption(SolveOptionTable(), text.substr(0, text.find('=')), text.substr(text.find('=') + 1),
              &options);
    ExpectError(ErrorKind::kUsage, {"engine direct"}, [&] { Solve(graph, options); });
    options.engine = Engine::kAutomatic;
    EXPECT_EQ(Solve(graph, options).report.linear_solver.find("block_normal_cholesky"),
              std::string::npos);
  }
}

TEST(DirectMinimiser, ConvergesWhereNothingHoldsTheGauge) {
  const Graph graph = Se2Loop(40, 0.05, 0.1);
  const Solution anchored = Solve(graph, To(Engine::kDirect));
  SolveOptions options = To(Engine::kDirect);
  options.anchor = Anchoring::kNone;
  const Solution loose = Solve(graph, options);
  EXPECT_EQ(loose.report.termination, Termination::kConverged) << loose.report.message;
  EXPECT_NEAR(loose.report.final_objective, anchored.report.final_objective,
              1e-9 * anchored.report.final_objective);
}

}  // namespace
}  // namespace graticule
