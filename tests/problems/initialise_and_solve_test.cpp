#include "graticule/problems/pose_graph/initialise_and_solve.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/bundle/simulate.hpp"
#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"

namespace graticule {
namespace {

constexpr InitialGuess kDefault = InitialGuess::kAutomatic;

// One robot without loops, whose odometry turns astray; landmarks alone hold it together.
Graph Astray(int poses, int landmarks, double sigma_rad, std::uint64_t seed) {
  CityOptions options;
  options.robots = 1;
  options.poses_per_robot = poses;
  options.landmarks = landmarks;
  options.loops_per_pose = options.inter_robot_per_pose = 0;
  options.odometry_sigma_rad = sigma_rad;
  options.seed = seed;
  return SimulateCity(Builtins(), options).graph;
}

// The default's solution is a minimum, and a bad one.
Graph BadMinimum() { return Astray(400, 5, 0.15, 8); }
// The default's solve does not converge.
Graph NoMinimum() { return Astray(800, 20, 0.1, 3); }

bool IsPlausible(const Report& report) {
  return ChiSquareShare(report.Chi2(), static_cast<double>(report.degrees_of_freedom)) < 1 - 1e-6;
}

TEST(SecondLook, IsNotTakenWhereTheNoiseExplainsTheFit) {
  Graph graph = SimulateCity(Builtins()).graph, alone = graph;
  const PoseGraphSolution solved = InitialiseAndSolve(&graph, kDefault, true);
  EXPECT_FALSE(solved.second_look);
  Initialise(&alone, kDefault, true);
  EXPECT_EQ(solved.solution.values.Data(), Solve(alone).values.Data());
  EXPECT_EQ(graph.InitialValues().Data(), alone.InitialValues().Data());
}

TEST(SecondLook, LeavesABadMinimumForTheIncrementalStart) {
  Graph graph = BadMinimum();
  const PoseGraphSolution solved = InitialiseAndSolve(&graph, kDefault, true);
  ASSERT_TRUE(solved.second_look);
  const SecondLook& look = *solved.second_look;
  EXPECT_EQ(look.first.start, InitialGuess::kChordal);
  EXPECT_EQ(look.first.termination, Termination::kConverged);
  ASSERT_TRUE(look.certificate);
  EXPECT_EQ(look.certificate->verdict, Verdict::kRefused);
  ASSERT_TRUE(look.second);
  EXPECT_EQ(look.second->start, InitialGuess::kIncremental);
  EXPECT_TRUE(look.improved);
  EXPECT_FALSE(look.was_stopped);
  EXPECT_EQ(solved.solution.report.final_objective, look.second->objective);
  EXPECT_LT(look.second->objective, 0.6 * look.first.objective);
  EXPECT_TRUE(IsPlausible(solved.solution.report));
  EXPECT_EQ(solved.start.used, InitialGuess::kIncremental);
  // The graph has the values that the solution was found from.
  EXPECT_EQ(Solve(graph).values.Data(), solved.solution.values.Data());
  EXPECT_NE(look.summary.find("not proved optimal; incremental ended at"), std::string::npos)
      << look.summary;

  Graph again = BadMinimum();
  EXPECT_EQ(InitialiseAndSolve(&again, kDefault, true).solution.values.Data(),
            solved.solution.values.Data());
}

TEST(SecondLook, DoesNotCertifyWhatDidNotConverge) {
  Graph graph = NoMinimum();
  const PoseGraphSolution solved = InitialiseAndSolve(&graph, kDefault, true);
  ASSERT_TRUE(solved.second_look);
  EXPECT_EQ(solved.second_look->first.termination, Termination::kNoConvergence);
  EXPECT_FALSE(solved.second_look->certificate);
  EXPECT_TRUE(solved.second_look->improved);
  EXPECT_EQ(solved.solution.report.termination, Termination::kConverged);
  EXPECT_TRUE(IsPlausible(solved.solution.report));
}

TEST(SecondLook, EndsWithTheProofWhereTheNoiseIsStatedTooSmall) {
  // Closures that are wrong, and no word of it.
  CityOptions options;
  options.robots = 1;
  options.poses_per_robot = 200;
  options.outlier_fraction = 0.02;
  Graph graph = SimulateCity(Builtins(), options).graph;
  const PoseGraphSolution solved = InitialiseAndSolve(&graph, kDefault, true);
  ASSERT_TRUE(solved.second_look);
  ASSERT_TRUE(solved.second_look->certificate);
  EXPECT_EQ(solved.second_look->certificate->verdict, Verdict::kOptimal);
  EXPECT_FALSE(solved.second_look->second);
  EXPECT_FALSE(solved.second_look->improved);
  EXPECT_GT(solved.second_look->reduced_chi2, 1);

  // What is certified is what was asked for, not the losses that were recorded.
  graph.SetLosses(MakeLoss("huber", 1));
  SolveOptions plain;
  plain.loss = "none";
  const PoseGraphSolution asked = InitialiseAndSolve(&graph, kDefault, true, plain);
  ASSERT_TRUE(asked.second_look && asked.second_look->certificate);
  EXPECT_EQ(asked.second_look->certificate->verdict, Verdict::kOptimal);
}

TEST(SecondLook, KeepsTheFirstWhereTheSecondIsWorse) {
  Graph graph = Astray(800, 20, 0.2, 1), alone = graph;
  const PoseGraphSolution solved = InitialiseAndSolve(&graph, kDefault, true);
  ASSERT_TRUE(solved.second_look);
  ASSERT_TRUE(solved.second_look->second);
  const double least =
      std::min(solved.second_look->first.objective, solved.second_look->second->objective);
  EXPECT_EQ(solved.solution.report.final_objective, least);
  Initialise(&alone, kDefault, true);
  EXPECT_FALSE(solved.second_look->improved);
  EXPECT_EQ(graph.InitialValues().Data(), alone.InitialValues().Data());
}

TEST(SecondLook, IsNotTakenWhereItMeansNothing) {
  const auto took = [](Graph graph, InitialGuess how, const SolveOptions& options) {
    return InitialiseAndSolve(&graph, how, true, options).second_look.has_value();
  };
  SolveOptions plain;
  plain.loss = "none";
  EXPECT_TRUE(took(BadMinimum(), kDefault, plain));
  EXPECT_FALSE(took(BadMinimum(), InitialGuess::kChordal, {}));
  EXPECT_FALSE(took(BadMinimum(), InitialGuess::kIncremental, {}));
  SolveOptions robust;
  robust.loss = "huber";
  EXPECT_FALSE(took(BadMinimum(), kDefault, robust));
  Graph recorded_robust = BadMinimum();
  recorded_robust.SetLosses(MakeLoss("cauchy", 1));
  EXPECT_FALSE(took(recorded_robust, kDefault, {}));
  SolveOptions few;
  few.max_iterations = 3;
  EXPECT_FALSE(took(BadMinimum(), kDefault, few));
  SolveOptions quick;
  quick.time_limit_s = 1e-9;
  EXPECT_FALSE(took(BadMinimum(), kDefault, quick));
}

TEST(SecondLook, KeepsTheBestSoFarWhereItIsStopped) {
  Graph graph = BadMinimum(), alone = graph;
  int updates = 0;
  double last = 0;
  bool searching = false;
  const Observer watch{[&](const Iteration& row) {
    // The rows of the incremental start begin anew at 1, with the objective of the first solution.
    searching = searching || (row.number == 1 && updates++ > 0 && row.objective == last);
    if (!searching) last = row.objective;
    return !searching;
  }};
  const PoseGraphSolution solved = InitialiseAndSolve(&graph, kDefault, true, {}, watch);
  ASSERT_TRUE(searching);
  ASSERT_TRUE(solved.second_look);
  EXPECT_TRUE(solved.second_look->was_stopped);
  EXPECT_FALSE(solved.second_look->improved);
  EXPECT_EQ(solved.solution.report.termination, Termination::kConverged);
  Initialise(&alone, kDefault, true);
  EXPECT_EQ(solved.solution.values.Data(), Solve(alone).values.Data());
  EXPECT_NE(solved.second_look->summary.find("stopped"), std::string::npos);
}

TEST(InitialiseAndSolve, SolvesWhatHasNoPosesAsItIs) {
  Graph graph = SimulateRing(Builtins()).graph, alone = graph;
  const PoseGraphSolution solved = InitialiseAndSolve(&graph, kDefault, true);
  EXPECT_FALSE(solved.second_look);
  EXPECT_EQ(solved.solution.values.Data(), Solve(alone).values.Data());
}

TEST(InitialiseAndSolve, CountsTheStartInTheTimeLimitAndNamesTheWholeOfIt) {
  Graph graph = BadMinimum();
  SolveOptions options;
  options.time_limit_s = 1e-6;
  const Solution solution = InitialiseAndSolve(&graph, kDefault, true, options).solution;
  EXPECT_EQ(solution.report.termination, Termination::kTimeLimit);
  EXPECT_NE(solution.report.message.find("1e-06 s"), std::string::npos) << solution.report.message;
  using Option = std::pair<std::string, std::string>;
  const std::vector<Option>& said = solution.report.options;
  EXPECT_EQ(std::count(said.begin(), said.end(), Option("time_limit_s", "1e-06")), 1);
}

}  // namespace
}  // namespace graticule
