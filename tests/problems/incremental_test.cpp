#include "graticule/problems/pose_graph/incremental.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/replay.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"

namespace graticule {
namespace {

const Noise kNoise = Noise::Sigmas({0.1, 0.1, 0.01});

Key Pose(std::uint64_t number) { return Key("pose", number); }

// Along x, a metre a step, turning left by `turn` radians each.
void Walk(const std::string& family, std::uint64_t poses, double turn, Graph* graph) {
  for (std::uint64_t i = 0; i < poses; ++i) graph->Add(Key(family, i), "se2/1", {0, 0, 0});
  for (std::uint64_t i = 1; i < poses; ++i)
    graph->Add(
        BetweenSe2Factor(Key(family, i - 1), Key(family, i), {1, 0, turn}, kNoise, "odometry"));
}

void ExpectValue(const Values& values, const char* key, const std::vector<double>& expected,
                 double tolerance = 1e-9) {
  const auto value = values.At(Key(key));
  ASSERT_EQ(value.size(), expected.size());
  for (std::size_t i = 0; i < value.size(); ++i)
    EXPECT_NEAR(value[i], expected[i], tolerance) << key << " field " << i;
}

std::vector<std::string> OrderOf(const Graph& graph) {
  Online online(graph.Types());
  Replay replay(graph, &online);
  while (!replay.IsDone()) replay.Next();
  online.Update();
  std::vector<std::string> keys;
  const Graph problem = online.Problem();
  for (VariableId id = 0; id < problem.VariableCount(); ++id)
    keys.push_back(problem.KeyOf(id).ToString());
  EXPECT_EQ(problem.FactorCount(), graph.FactorCount());
  return keys;
}

// Families are trajectories: the second begins where the first met it, and goes both ways.
TEST(Replay, TakesAFamilyInOrderAndTheNextFromWhereItWasMet) {
  Graph graph(Builtins());
  Walk("a", 4, 0, &graph);
  Walk("b", 4, 0, &graph);
  graph.Add(BetweenSe2Factor(Key("a:1"), Key("b:2"), {0, 1, 0}, kNoise, "meeting"));
  graph.Add(Key("landmark:7"), "point2/1", {0, 0});
  graph.Add(Factor{
      "landmark_se2/1", {Key("a:2"), Key("landmark:7")}, {1, 1}, Noise::Sigma(0.1), Loss{}, ""});
  graph.Add(Key("nobody:0"), "se2/1", {0, 0, 0});
  EXPECT_EQ(OrderOf(graph), (std::vector<std::string>{"a:0", "a:1", "a:2", "landmark:7", "a:3",
                                                      "b:2", "b:1", "b:0", "b:3"}));
}

TEST(Replay, BeginsAtWhatIsFixedAndTakesPriorsInTheirTurn) {
  Graph graph(Builtins());
  Walk("a", 3, 0, &graph);
  Walk("b", 3, 0, &graph);
  graph.Add(Key("mark:0"), "point2/1", {2, 0});
  graph.SetValue(graph.IdOf(Key("b:1")), std::vector<double>{5, 5, 0});
  graph.SetFixed(graph.IdOf(Key("b:1")), true);
  graph.Add(Factor{"prior_se2/1", {Key("a:1")}, {1, 2, 0.5}, kNoise, Loss{}, "prior"});
  graph.Add(Factor{"prior_point2/1", {Key("mark:0")}, {3, 1}, Noise::Sigma(1), Loss{}, "prior"});
  EXPECT_EQ(OrderOf(graph),
            (std::vector<std::string>{"b:1", "a:1", "mark:0", "a:0", "a:2", "b:0", "b:2"}));

  Values values = graph.InitialValues();
  const IncrementalReport report = PlaceIncrementally(graph, &values);
  EXPECT_TRUE(report.is_complete) << report.failure;
  EXPECT_EQ(report.poses, 5u);
  EXPECT_EQ(report.roots, 2u);
  EXPECT_EQ(report.free_roots, 0u);
  ExpectValue(values, "a:2", {1 + std::cos(0.5), 2 + std::sin(0.5), 0.5});
  ExpectValue(values, "b:0", {4, 5, 0});
  ExpectValue(values, "mark:0", {3, 1});
}

// Odometry that turns by a tenth too much: 36 degrees a round, which every closure denies.
TEST(Incremental, ClosesLoopsWhereOdometryDriftsOff) {
  Graph graph(Builtins());
  Walk("pose", 201, 1.1 * 2 * M_PI / 40, &graph);
  for (std::uint64_t i = 40; i < 201; ++i)
    graph.Add(BetweenSe2Factor(Pose(i - 40), Pose(i), {0, 0, 0}, kNoise, "loop"));
  Values values = graph.InitialValues();
  EXPECT_TRUE(PlaceIncrementally(graph, &values).is_complete);
  Graph placed = graph, chordal = graph;
  placed.SetValues(values);
  const Report from_incremental = Solve(placed).report;
  Initialise(&chordal, InitialGuess::kChordal, false);
  const double best = Solve(chordal).report.final_cost;
  EXPECT_NEAR(from_incremental.final_cost, best, 1e-6 * best);
  // Every update was a step of Gauss-Newton: what is left to do is little.
  EXPECT_LT(from_incremental.initial_cost, 1.01 * best);
}

TEST(Incremental, PlacesPiecesEachFromItsFirstPose) {
  Graph graph(Builtins());
  Walk("a", 5, 0, &graph);
  Walk("b", 5, 0.1, &graph);
  graph.SetValue(graph.IdOf(Key("b:0")), std::vector<double>{100, 0, M_PI / 2});
  graph.Add(BetweenSe2Factor(Key("a:0"), Key("a:4"), {4, 0, 0}, kNoise, "loop"));
  Values values = graph.InitialValues();
  const IncrementalReport report = PlaceIncrementally(graph, &values);
  EXPECT_TRUE(report.is_complete) << report.failure;
  EXPECT_EQ(report.roots, 2u);
  EXPECT_EQ(report.free_roots, 2u);
  ExpectValue(values, "a:0", {0, 0, 0});
  ExpectValue(values, "a:4", {4, 0, 0});
  ExpectValue(values, "b:0", {100, 0, M_PI / 2});
  ExpectValue(values, "b:1", {100, 1, M_PI / 2 + 0.1});
}

// The place of such a landmark is known when a second line of sight crosses the first.
TEST(Incremental, PlacesLandmarksFromBearingsThatCross) {
  Graph graph(Builtins());
  Walk("pose", 6, 0, &graph);
  graph.Add(Key("landmark:0"), "point2/1", {0, 0});
  graph.Add(Key("landmark:1"), "point2/1", {0, 0});
  const auto see = [&](std::uint64_t pose, const char* landmark, double bearing_rad) {
    graph.Add(Factor{"bearing_se2/1",
                     {Pose(pose), Key(landmark)},
                     {bearing_rad},
                     Noise::Sigma(0.01),
                     Loss{},
                     "sighting"});
  };
  for (std::uint64_t i = 0; i < 6; ++i)
    see(i, "landmark:0", std::atan2(4.0, 3.0 - static_cast<double>(i)));
  see(2, "landmark:1", M_PI / 2);  // one bearing: ten metres to the left
  Values values = graph.InitialValues();
  const IncrementalReport report = PlaceIncrementally(graph, &values);
  EXPECT_TRUE(report.is_complete) << report.failure;
  EXPECT_EQ(report.landmarks.placed, 2u);
  EXPECT_EQ(report.landmarks.assumed, 1u);
  ExpectValue(values, "landmark:0", {3, 4});
  ExpectValue(values, "landmark:1", {2, 10}, 1e-6);
  ExpectValue(values, "pose:5", {5, 0, 0});
}

CityOptions NoisyCity(int dimension) {
  CityOptions options;
  options.dimension = dimension;
  options.robots = 3;
  options.poses_per_robot = 100;
  options.landmarks = 20;
  return options;
}

TEST(Incremental, LeadsToTheMinimumOfNoisyCitiesWithTheSameDigitsEachTime) {
  for (const int dimension : {2, 3}) {
    Simulated city = SimulateCity(Builtins(), NoisyCity(dimension));
    Graph incremental = city.graph, again = city.graph, chordal = city.graph;
    const InitialiseReport report = Initialise(&incremental, InitialGuess::kIncremental, false);
    EXPECT_EQ(report.used, InitialGuess::kIncremental);
    EXPECT_NE(report.summary.find("solved in"), std::string::npos) << report.summary;
    Initialise(&again, InitialGuess::kIncremental, false);
    EXPECT_EQ(incremental.InitialValues().Data(), again.InitialValues().Data());
    Initialise(&chordal, InitialGuess::kChordal, false);
    const double best = Solve(chordal).report.final_cost;
    EXPECT_NEAR(Solve(incremental).report.final_cost, best, 1e-6 * best);
  }
}

TEST(Incremental, PlacesTheRestUnsolvedWhereItIsStopped) {
  Simulated city = SimulateCity(Builtins(), NoisyCity(2));
  int rows = 0;
  const Observer watch{[&](const Iteration& row) {
    EXPECT_TRUE(std::isnan(row.objective));
    EXPECT_EQ(row.number, ++rows);
    return rows < 2;
  }};
  Values values = city.graph.InitialValues();
  const IncrementalReport report = PlaceIncrementally(city.graph, &values, {}, watch);
  EXPECT_EQ(rows, 2);
  EXPECT_EQ(report.updates, 2u);
  EXPECT_FALSE(report.is_complete);
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.poses, 299u);
  EXPECT_EQ(report.landmarks.placed, 20u);
}

// A type that is only declared cannot be solved with; Solve says so better.
TEST(Incremental, PlacesUnsolvedWhatCannotBeSolved) {
  Graph graph(Builtins());
  Walk("pose", 4, 0, &graph);
  graph.DeclareFactorType("mystery/1", "a:se2/1 b:se2/1 | x:m");
  graph.Add(Factor{"mystery/1", {Pose(0), Pose(2)}, {1}, Noise::Sigma(1), Loss{}, ""});
  Values values = graph.InitialValues();
  const IncrementalReport report = PlaceIncrementally(graph, &values);
  EXPECT_FALSE(report.is_complete);
  EXPECT_NE(report.failure.find("mystery/1"), std::string::npos) << report.failure;
  ExpectValue(values, "pose:3", {3, 0, 0});
}

TEST(Incremental, LeavesAGraphOfFixedPosesAsItIs) {
  Graph graph(Builtins());
  Walk("pose", 3, 0, &graph);
  for (VariableId id = 0; id < graph.VariableCount(); ++id) graph.SetFixed(id, true);
  graph.Add(Key("landmark:0"), "point2/1", {0, 0});
  graph.Add(Factor{"landmark_se2/1",
                   {Pose(1), Key("landmark:0")},
                   {1, 1},
                   Noise::Sigma(0.1),
                   Loss{},
                   "sighting"});
  Values values = graph.InitialValues();
  const IncrementalReport report = PlaceIncrementally(graph, &values);
  EXPECT_TRUE(report.is_complete);
  EXPECT_EQ(report.poses, 0u);
  ExpectValue(values, "pose:2", {0, 0, 0});
  ExpectValue(values, "landmark:0", {1, 1});
}

}  // namespace
}  // namespace graticule
