// Problems with known answers.

#include "graticule/solver/solve.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "expect_error.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Gauss;
using testing::Linearise;
using testing::Numbers;
using testing::Random;
using testing::Se2Loop;
using testing::Se3Loop;
using testing::TestTypes;

TEST(Solve, FitsALineAsTheClosedFormDoes) {
  Random random(1);
  Graph graph(TestTypes());
  graph.Add(Key("line:0"), "vector2/1", {0, 0});
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int i = 0; i < 20; ++i) {
    const double x = 0.5 * i, y = 3 - 0.7 * x + Gauss(&random, 0.2);
    graph.Add({"line/1", {Key("line:0")}, {x, y}, Noise::Sigma(0.2), {}, ""});
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const Solution solution = Solve(graph);
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  EXPECT_EQ(solution.report.termination, Termination::kConverged);
  EXPECT_NEAR(solution.values.At(Key("line:0"))[1], slope, 1e-12);
  EXPECT_NEAR(solution.values.At(Key("line:0"))[0], (sy - slope * sx) / n, 1e-12);
  EXPECT_EQ(solution.report.degrees_of_freedom, 18);
}

TEST(Solve, AgreesWithTheNormalEquationsOnALinearProblem) {
  constexpr std::uint64_t kSeed = 2;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Random random(kSeed);
  Graph graph(TestTypes());
  for (unsigned i = 0; i < 5; ++i) {
    graph.Add(Key("a", i), "vector2/1", {Gauss(&random, 1), Gauss(&random, 1)});
    graph.Add(Key("b", i), "vector3/1", {0, 0, 0});
  }
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(40, 25);
  Eigen::VectorXd z(40);
  for (unsigned f = 0; f < 20; ++f) {
    Numbers m(12);
    for (double& x : m) x = Gauss(&random, 1);
    const Eigen::Matrix2d root =
        (Eigen::Matrix2d() << 1 + 0.1 * f, 0.5, 0, 2).finished();  // W = root' root
    const Eigen::Matrix2d w = root.transpose() * root;
    const unsigned a = f % 5, b = (f * 7 + f / 5) % 5;
    graph.Add({"linear/1",
               {Key("a", a), Key("b", b)},
               m,
               Noise::Information({w(0, 0), w(0, 1), w(1, 1)}),
               {},
               ""});
    Eigen::Matrix<double, 2, 5> row;
    row << m[0], m[1], m[4], m[5], m[6], m[2], m[3], m[7], m[8], m[9];
    j.block<2, 2>(2 * f, 2 * a) = root * row.leftCols<2>();
    j.block<2, 3>(2 * f, 10 + 3 * b) = root * row.rightCols<3>();
    z.segment<2>(2 * f) = root * Eigen::Vector2d(m[10], m[11]);
  }
  const Eigen::VectorXd x = (j.transpose() * j).ldlt().solve(j.transpose() * z);
  const Solution solution = Solve(graph);
  for (unsigned i = 0; i < 5; ++i) {
    for (unsigned c = 0; c < 2; ++c)
      EXPECT_NEAR(solution.values.At(Key("a", i))[c], x(2 * i + c), 1e-9);
    for (unsigned c = 0; c < 3; ++c)
      EXPECT_NEAR(solution.values.At(Key("b", i))[c], x(10 + 3 * i + c), 1e-9);
  }
  EXPECT_NEAR(solution.report.Chi2(), (j * x - z).squaredNorm(), 1e-9);
  EXPECT_EQ(solution.report.parameters, 25u);
  EXPECT_EQ(solution.report.degrees_of_freedom, 15);
}

TEST(Solve, ClosesAnExactLoopExactly) {
  for (const Graph& graph : {Se2Loop(40, 0, 0.05), Se3Loop(40, 0, 0.05)}) {
    const Solution solution = Solve(graph);
    EXPECT_EQ(solution.report.termination, Termination::kConverged);
    EXPECT_LT(solution.report.final_cost, 1e-16);
    EXPECT_GT(solution.report.initial_cost, 1);
    ASSERT_EQ(solution.report.anchors.size(), 1u);
    EXPECT_EQ(solution.report.anchors[0], graph.KeyOf(0).ToString());
  }
}

// At a minimum the gradient is zero: looked at through differences that the solver had no part in.
TEST(Solve, EndsWhereTheGradientIsZero) {
  for (const Graph& graph : {Se2Loop(30, 0.05, 0.1), Se3Loop(30, 0.02, 0.05)}) {
    const Solution solution = Solve(graph);
    EXPECT_EQ(solution.report.termination, Termination::kConverged) << solution.report.message;
    const testing::Dense dense = Linearise(graph, solution.values, {graph.KeyOf(0)});
    // What a Newton step from here would still gain, against the tolerance of 1e-9.
    const Eigen::VectorXd gradient = dense.jacobian.transpose() * dense.residual;
    const Eigen::VectorXd step =
        (dense.jacobian.transpose() * dense.jacobian).ldlt().solve(gradient);
    EXPECT_LT(gradient.dot(step), 1e-8 * solution.report.Chi2());
  }
}

TEST(Solve, LeavesTheGraphAndFixedVariablesAlone) {
  Graph graph = Se2Loop(10, 0.05, 0.1);
  graph.SetFixed(0, true);
  graph.SetFixed(4, true);
  const Numbers before = graph.InitialValues().Data();
  const Solution solution = Solve(graph);
  EXPECT_EQ(graph.InitialValues().Data(), before);
  EXPECT_TRUE(solution.report.anchors.empty()) << "something is fixed: no anchor is needed";
  EXPECT_EQ(solution.report.fixed_variables, 2u);
  for (const VariableId id : {0u, 4u})
    for (unsigned i = 0; i < 3; ++i) EXPECT_EQ(solution.values[id][i], graph.ValueOf(id)[i]);
  EXPECT_NE(solution.values[1][0], graph.ValueOf(1)[0]);
}

TEST(Solve, WithNothingFreeReportsTheCosts) {
  Graph graph = Se2Loop(3, 0.05, 0.1);
  for (VariableId id = 0; id < 3; ++id) graph.SetFixed(id, true);
  const Report report = Solve(graph).report;
  EXPECT_EQ(report.termination, Termination::kConverged);
  EXPECT_EQ(report.final_cost, report.initial_cost);
  EXPECT_GT(report.final_cost, 0);
  EXPECT_NEAR(report.final_objective, report.final_cost, 1e-12);
}

TEST(Solve, OfAnEmptyGraphConverges) {
  const Solution solution = Solve(Graph(TestTypes()));
  EXPECT_EQ(solution.report.termination, Termination::kConverged) << solution.report.message;
  EXPECT_EQ(solution.report.final_cost, 0);
}

TEST(Solve, AnchorsThePoseAndNotTheLandmarkBeforeIt) {
  Graph graph(TestTypes());
  graph.Add(Key("landmark:0"), "point2/1", {2, 1});
  graph.Add(Key("pose:0"), "se2/1", {0, 0, 0});
  graph.Add(Key("pose:1"), "se2/1", {1, 0, 0});
  graph.Add(BetweenSe2Factor(Key("pose:0"), Key("pose:1"), {1, 0, 0}, Noise::Sigma(0.1)));
  graph.Add(LandmarkSe2Factor(Key("pose:1"), Key("landmark:0"), {1, 1}, Noise::Sigma(0.1)));
  EXPECT_EQ(Solve(graph).report.anchors, (std::vector<std::string>{"pose:0"}));
}

TEST(Solve, NeedsNoAnchorWhereAFactorIsAbsolute) {
  Graph graph = Se2Loop(5, 0.01, 0.1);
  graph.Add(PriorSe2Factor(Key("pose:2"), {9, 9, 1}, Noise::Sigma(0.1)));
  const Solution solution = Solve(graph);
  EXPECT_TRUE(solution.report.anchors.empty());
  EXPECT_NEAR(solution.values.At(Key("pose:2"))[0], 9, 1e-6);
}

TEST(Solve, BelievesOutliersLessByTheLossOfAFactor) {
  Graph graph(TestTypes());
  graph.Add(Key("x:0"), "vector1/1", {0});
  for (const double measured : {1.0, 1.1, 0.9, 1.05, 0.95, 100.0})
    graph.Add({"limited/1", {Key("x:0")}, {measured, -1e9}, Noise::Sigma(0.1), {}, ""});
  EXPECT_NEAR(Solve(graph).values.At(Key("x:0"))[0], 17.5, 1e-9) << "least squares: the mean";
  SolveOptions options;
  options.loss = "huber";
  options.loss_scale = 1.345;
  const Solution huber = Solve(graph, options);
  // Inliers hold with r / sigma^2 each, the outlier pulls with 1.345 / sigma: 5 (x - 1) / 0.1
  // = 1.345.
  EXPECT_NEAR(huber.values.At(Key("x:0"))[0], 1 + 0.1 * 1.345 / 5, 1e-5);
  EXPECT_LT(huber.report.worst[0].weight, 0.01);
  EXPECT_EQ(huber.report.worst[0].id, 5u);
  EXPECT_EQ(graph.FactorAt(5).loss.kind, LossKind::kNone) << "the graph keeps its own losses";
  options.loss = "none";
  graph.SetLosses({LossKind::kHuber, 1});
  EXPECT_NEAR(Solve(graph, options).values.At(Key("x:0"))[0], 17.5, 1e-9);
}

TEST(Solve, ObjectiveIsHalfTheSumOfRho) {
  Graph graph = Se2Loop(20, 0.3, 0.1);
  for (const std::string_view name : LossNames()) {
    graph.SetLosses(MakeLoss(name, 2));
    const Solution solution = Solve(graph);
    double objective = 0;
    for (const double chi2 : FactorChi2(graph, solution.values)) {
      double rho[3];
      EvaluateLoss(graph.FactorAt(0).loss, chi2, rho);
      objective += 0.5 * rho[0];
    }
    EXPECT_NEAR(solution.report.final_objective, objective, 1e-9 * objective) << name;
    EXPECT_LE(solution.report.final_objective, solution.report.initial_objective) << name;
  }
}

TEST(Solve, CostsAreHalfTheSumOfChi2AndSharedByTypeAndSource) {
  const Graph graph = Se2Loop(20, 0.1, 0.1);
  const Solution solution = Solve(graph);
  const Report& report = solution.report;
  const auto half = [](const Numbers& chi2) {
    return 0.5 * std::accumulate(chi2.begin(), chi2.end(), 0.0);
  };
  const Numbers chi2 = FactorChi2(graph, solution.values);
  EXPECT_DOUBLE_EQ(report.final_cost, half(chi2));
  EXPECT_DOUBLE_EQ(report.initial_cost, half(FactorChi2(graph, graph.InitialValues())));
  EXPECT_NEAR(report.final_objective, report.final_cost, 1e-12 * report.final_cost);
  ASSERT_EQ(report.shares.size(), 2u);
  EXPECT_EQ(report.shares[0].source, "odometry");
  EXPECT_EQ(report.shares[0].factors, 19u);
  EXPECT_EQ(report.shares[1].residuals, 3u);
  EXPECT_NEAR(report.shares[0].final_cost + report.shares[1].final_cost, report.final_cost, 1e-12);
  ASSERT_EQ(report.worst.size(), 5u);
  EXPECT_EQ(report.worst[0].chi2, *std::max_element(chi2.begin(), chi2.end()));
  for (std::size_t i = 1; i < 5; ++i) EXPECT_GE(report.worst[i - 1].chi2, report.worst[i].chi2);
  EXPECT_EQ(report.residuals, 60u);
  EXPECT_EQ(report.parameters, 57u);
  EXPECT_EQ(report.degrees_of_freedom, 3);
  EXPECT_DOUBLE_EQ(report.ReducedChi2(), report.Chi2() / 3);
}

TEST(Solve, ReportsEveryIterationToTheObserverAndInTheReport) {
  const Graph graph = Se2Loop(20, 0.1, 0.1);
  std::vector<int> numbers;
  Observer watch;
  watch.on_iteration = [&](const Iteration& row) {
    numbers.push_back(row.number);
    return true;
  };
  const Report report = Solve(graph, {}, watch).report;
  ASSERT_EQ(numbers.size(), report.iterations.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], static_cast<int>(i));
  EXPECT_EQ(report.iterations[0].objective, report.initial_objective);
  EXPECT_EQ(report.iterations.back().objective, report.final_objective);
  EXPECT_EQ(report.options.size(), SolveOptionTable().size());
  EXPECT_FALSE(report.provenance.empty());
  EXPECT_GT(report.timing.total.wall, 0);
}

TEST(Solve, GoesOnFromWhereItWas) {
  Graph graph = Se2Loop(50, 0.1, 0.1);
  const Solution first = Solve(graph);
  graph.SetValues(first.values);
  const Solution second = Solve(graph);
  EXPECT_LE(second.report.Steps(), 1u);
  EXPECT_NEAR(second.report.final_cost, first.report.final_cost, 1e-9 * first.report.final_cost);
}

// --- every way to the optimum

class EveryMachine
    : public ::testing::TestWithParam<std::tuple<const char*, const char*, const char*>> {};

TEST_P(EveryMachine, ReachesTheSameOptimumOrIsRefusedAsUsage) {
  SolveOptions options;
  const auto set = [&](const char* name, const std::string& value) {
    SetOption(SolveOptionTable(), name, value, &options);
  };
  set("method", std::get<0>(GetParam()));
  set("linear_solver", std::get<1>(GetParam()));
  set("linear_algebra", std::get<2>(GetParam()));
  set("max_linear_iterations", "5000");
  set("initial_trust_region_radius", "1e4");
  const bool dogleg =
      options.method == Method::kDogleg || options.method == Method::kSubspaceDogleg;
  const bool iterative = options.linear_solver == LinearSolver::kCgnr ||
                         options.linear_solver == LinearSolver::kIterativeSchur;
  // Poses and landmarks: an elimination exists.
  Random random(8);
  Graph graph = Se2Loop(12, 0.05, 0.05);
  for (unsigned l = 0; l < 6; ++l) {
    graph.Add(Key("landmark", l), "point2/1", {Gauss(&random, 2), Gauss(&random, 2)});
    for (unsigned i = l; i < 12; i += 3)
      graph.Add(LandmarkSe2Factor(Key("pose", i), Key("landmark", l),
                                  {Gauss(&random, 1), Gauss(&random, 1)}, Noise::Sigma(0.5)));
  }
  const Solution expected = Solve(graph);
  ASSERT_EQ(expected.report.termination, Termination::kConverged);
  if (dogleg && iterative) {
    ExpectError(ErrorKind::kUsage, {"do not go together"}, [&] { Solve(graph, options); });
    return;
  }
  const Solution solution = Solve(graph, options);
  EXPECT_EQ(solution.report.termination, Termination::kConverged) << solution.report.message;
  // Conjugate gradients end each step early: function_tolerance 1e-9 is then reached further out.
  EXPECT_NEAR(solution.report.final_objective, expected.report.final_objective,
              (iterative ? 1e-6 : 1e-8) * expected.report.final_objective);
  for (std::size_t i = 0; i < expected.values.Data().size(); ++i)
    EXPECT_NEAR(solution.values.Data()[i], expected.values.Data()[i], iterative ? 2e-2 : 1e-4);
}

INSTANTIATE_TEST_SUITE_P(All, EveryMachine,
                         ::testing::Combine(::testing::Values("levenberg_marquardt", "gauss_newton",
                                                              "dogleg", "subspace_dogleg"),
                                            ::testing::Values("automatic", "sparse_normal_cholesky",
                                                              "dense_normal_cholesky", "dense_qr",
                                                              "cgnr", "dense_schur", "sparse_schur",
                                                              "iterative_schur"),
                                            ::testing::Values("suite_sparse", "eigen_sparse")),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param)) + "_" +
                                  std::get<1>(info.param) + "_" + std::get<2>(info.param);
                         });

TEST(Solve, TakesEveryPreconditionerOrRefusesIt) {
  const Graph graph = Se2Loop(12, 0.05, 0.05);
  for (const auto solver : {LinearSolver::kCgnr, LinearSolver::kIterativeSchur})
    for (const auto preconditioner :
         {Preconditioner::kIdentity, Preconditioner::kJacobi, Preconditioner::kSchurJacobi}) {
      SolveOptions options;
      options.linear_solver = solver;
      options.preconditioner = preconditioner;
      try {
        const Report report = Solve(graph, options).report;
        EXPECT_LT(report.final_objective, report.initial_objective);
      } catch (const Error& error) {
        EXPECT_EQ(error.Kind(), ErrorKind::kUsage) << error.what();
      }
    }
}

}  // namespace
}  // namespace graticule
