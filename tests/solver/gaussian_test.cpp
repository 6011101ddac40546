// The factor that marginalising leaves, by itself: what it states, and what it refuses.

#include "graticule/solver/gaussian.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_error.hpp"
#include "graticule/solver/check.hpp"
#include "graticule/solver/solve.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Numbers;
using testing::TestTypes;

// A pose, a point, a rotation in space: columns 3 + 2 + 3, rows as wanted.
Graph Mixed(const Gaussian& gaussian) {
  Graph graph(TestTypes());
  graph.Add(Key("pose:0"), "se2/1", {1, 2, 3.0});
  graph.Add(Key("tree:0"), "point2/1", {4, 5});
  graph.Add(Key("turn:0"), "so3/1", {0.5, 0.5, 0.5, 0.5});
  graph.Add({kGaussian,
             {Key("pose:0"), Key("tree:0"), Key("turn:0")},
             gaussian.Measurement(),
             Noise::Unit(),
             {},
             "marginal"});
  return graph;
}

Gaussian Triangular() {
  Gaussian gaussian;
  gaussian.rows = gaussian.columns = 8;
  gaussian.point = {0.5, 2, -3.0, 4, 6, 0, 0, 0, 1};
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column)
      gaussian.r.push_back(column < row ? 0 : 1.0 / (1 + row + 2 * column));
    gaussian.b.push_back(0.01 * row);
  }
  return gaussian;
}

TEST(Gaussian, IsItsMatrixTimesTheDifferencesOnTheManifolds) {
  const Gaussian gaussian = Triangular();
  const Graph graph = Mixed(gaussian);
  Numbers difference(8);
  graph.TypeOf(0).Minus(graph.ValueOf(0).data(), gaussian.point.data(), difference.data());
  EXPECT_NEAR(difference[2], 6 - 2 * M_PI, 1e-15) << "the shorter way round";
  graph.TypeOf(1).Minus(graph.ValueOf(1).data(), gaussian.point.data() + 3, difference.data() + 3);
  graph.TypeOf(2).Minus(graph.ValueOf(2).data(), gaussian.point.data() + 5, difference.data() + 5);
  double chi2 = 0;
  for (std::size_t row = 0; row < 8; ++row) {
    double residual = -gaussian.b[row];
    for (std::size_t k = 0; k < 8; ++k) residual += gaussian.r[row * 8 + k] * difference[k];
    chi2 += residual * residual;
  }
  EXPECT_NEAR(FactorChi2(graph, graph.InitialValues())[0], chi2, 1e-12 * chi2);
  const auto checks = CheckJacobians(graph, graph.InitialValues());
  EXPECT_EQ(checks[0].wrong + checks[0].failed, 0u);
  EXPECT_LT(checks[0].worst, 1e-8);
}

TEST(Gaussian, IsSolvedAlikeByEveryEngine) {
  const Graph graph = Mixed(Triangular());
  for (const Engine engine : {Engine::kDirect, Engine::kCeres}) {
    SolveOptions options;
    options.engine = engine;
    options.max_iterations = 100;
    const Solution solution = Solve(graph, options);
    EXPECT_EQ(solution.report.termination, Termination::kConverged);
    EXPECT_NEAR(solution.report.final_objective, 0, 1e-12);
  }
}

TEST(Gaussian, RefusesNumbersThatAreNotOfItsVariables) {
  Gaussian short_of_columns = Triangular();
  short_of_columns.columns = 7;
  short_of_columns.r.resize(8 * 7);
  ExpectError(ErrorKind::kInput, {"gaussian/1", "pose:0", "7 columns", "need 8 and 9"},
              [&] { Mixed(short_of_columns); });
  Gaussian no_point = Triangular();
  no_point.point.clear();
  ExpectError(ErrorKind::kInput, {"gaussian/1", "fewer numbers"}, [&] { Mixed(no_point); });
  Gaussian no_rows = Triangular();
  no_rows.rows = 0;
  ExpectError(ErrorKind::kInput, {"gaussian/1", "rows and columns"}, [&] { Mixed(no_rows); });
}

}  // namespace
}  // namespace graticule
