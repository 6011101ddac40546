#include "graticule/problems/pose_graph/initialise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

const Noise kNoise = Noise::Sigma(0.1);

// Largest difference of any number; quaternions up to their sign.
double Difference(const Values& a, const Values& b) {
  double worst = 0;
  for (VariableId id = 0; id < a.Count(); ++id) {
    const auto x = a[id], y = b[id];
    double sign = 1;
    if (x.size() == 7) sign = x[3] * y[3] + x[4] * y[4] + x[5] * y[5] + x[6] * y[6] < 0 ? -1 : 1;
    for (std::size_t i = 0; i < x.size(); ++i) {
      double difference = std::abs(x[i] - (i >= 3 ? sign : 1) * y[i]);
      if (x.size() == 3 && i == 2) difference = std::min(difference, 2 * M_PI - difference);
      worst = std::max(worst, difference);
    }
  }
  return worst;
}

// All but fixed variables at zero, as after reading a file without a guess.
void Forget(Graph* graph) {
  for (VariableId id = 0; id < graph->VariableCount(); ++id) {
    std::vector<double> zero(graph->ValueOf(id).size());
    if (zero.size() == 7) zero[6] = 1;
    if (!graph->IsFixed(id)) graph->SetValue(id, zero);
  }
}

struct Case {
  int dimension;
  InitialGuess how;
};

class NoiseFreeCity : public ::testing::TestWithParam<Case> {};

TEST_P(NoiseFreeCity, IsRecovered) {
  CityOptions options;
  options.dimension = GetParam().dimension;
  options.robots = 3;
  options.poses_per_robot = 300;
  options.landmarks = 30;
  // Errors of 1e-15 m and rad a step, over 300 steps and 200 m, stay below 1e-11 m.
  options.odometry_sigma_m = options.closure_sigma_m = options.landmark_sigma_m = 1e-15;
  options.odometry_sigma_rad = options.closure_sigma_rad = 1e-15;
  Simulated city = SimulateCity(Builtins(), options);
  Forget(&city.graph);
  const InitialiseReport report = Initialise(&city.graph, GetParam().how, false);
  EXPECT_LT(Difference(city.graph.InitialValues(), city.truth), 1e-9) << report.summary;
  EXPECT_EQ(report.poses, 899u);
  EXPECT_EQ(report.landmarks, 30u);
  EXPECT_EQ(report.set, 929u);
  EXPECT_EQ(report.roots, 1u);
  EXPECT_EQ(report.free_roots, 0u);
  if (GetParam().how == InitialGuess::kAutomatic)
    EXPECT_EQ(report.candidates.size(), 2u);  // noise free, they differ by rounding only
  else
    EXPECT_EQ(report.used, GetParam().how);
}

TEST_P(NoiseFreeCity, IsRecoveredFromAPriorAndAFixedPose) {
  CityOptions options;
  options.dimension = GetParam().dimension;
  options.robots = 2;
  options.poses_per_robot = 100;
  options.landmarks = 10;
  options.odometry_sigma_m = options.closure_sigma_m = options.landmark_sigma_m = 1e-15;
  options.odometry_sigma_rad = options.closure_sigma_rad = 1e-15;
  Simulated city = SimulateCity(Builtins(), options);
  Graph& graph = city.graph;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) graph.SetFixed(id, false);
  Forget(&graph);
  const auto truth_of = [&](const char* key) {
    const auto truth = city.truth.At(Key(key));
    return std::vector<double>(truth.begin(), truth.end());
  };
  const char* prior = options.dimension == 2 ? "prior_se2/1" : "prior_se3/1";
  graph.Add(Factor{
      prior, {Key("robot1:40")}, truth_of("robot1:40"), Noise::Sigma(1e-15), Loss{}, "prior"});
  const auto only_prior = Initialise(&graph, GetParam().how, false);
  EXPECT_LT(Difference(graph.InitialValues(), city.truth), 1e-9) << only_prior.summary;
  EXPECT_EQ(only_prior.free_roots, 0u);

  graph.SetValue(graph.IdOf(Key("robot2:70")), truth_of("robot2:70"));
  graph.SetFixed(graph.IdOf(Key("robot2:70")), true);
  Forget(&graph);
  const auto both = Initialise(&graph, GetParam().how, false);
  EXPECT_LT(Difference(graph.InitialValues(), city.truth), 1e-9) << both.summary;
}

INSTANTIATE_TEST_SUITE_P(
    Methods, NoiseFreeCity,
    ::testing::Values(Case{2, InitialGuess::kAutomatic}, Case{2, InitialGuess::kOdometry},
                      Case{2, InitialGuess::kSpanningTree},
                      Case{2, InitialGuess::kMinimumSpanningTree}, Case{2, InitialGuess::kChordal},
                      Case{2, InitialGuess::kLago}, Case{2, InitialGuess::kIncremental},
                      Case{3, InitialGuess::kIncremental}, Case{3, InitialGuess::kAutomatic},
                      Case{3, InitialGuess::kMinimumSpanningTree}, Case{3, InitialGuess::kChordal},
                      Case{3, InitialGuess::kOdometry}, Case{3, InitialGuess::kSpanningTree}));

TEST(Initialise, GivesTheSameDigitsAsTheSimulatorWhereItChainsOdometry) {
  CityOptions options;
  options.robots = 1;
  options.poses_per_robot = 200;
  Simulated city = SimulateCity(Builtins(), options);
  const Values odometry = city.graph.InitialValues();
  Forget(&city.graph);
  Initialise(&city.graph, InitialGuess::kOdometry, false);
  EXPECT_EQ(city.graph.InitialValues().Data(), odometry.Data());
}

TEST(Initialise, LeavesTheFilesGuessAloneWhereToldToOrWithoutALoop) {
  Simulated city = SimulateCity(Builtins());
  const Values before = city.graph.InitialValues();
  EXPECT_EQ(Initialise(&city.graph, InitialGuess::kFile, false).set, 0u);
  EXPECT_EQ(city.graph.InitialValues().Data(), before.Data());

  Graph line(Builtins());
  for (std::uint64_t i = 0; i < 3; ++i) line.Add(Key("pose", i), "se2/1", {9, 9, 0});
  for (std::uint64_t i = 0; i < 2; ++i)
    line.Add(BetweenSe2Factor(Key("pose", i), Key("pose", i + 1), {1, 0, 0}, kNoise));
  const InitialiseReport report = Initialise(&line, InitialGuess::kAutomatic, true);
  EXPECT_EQ(report.used, InitialGuess::kFile);
  EXPECT_TRUE(report.candidates.empty());
  EXPECT_EQ(Initialise(&line, InitialGuess::kAutomatic, false).used, InitialGuess::kSpanningTree);
}

TEST(Initialise, AutomaticKeepsASolvedFileAndSaysWhatItChoseFrom) {
  for (const int dimension : {2, 3}) {
    CityOptions options;
    options.dimension = dimension;
    options.robots = 2;
    options.poses_per_robot = 200;
    options.landmarks = 20;
    Simulated city = SimulateCity(Builtins(), options);
    const InitialiseReport first = Initialise(&city.graph, InitialGuess::kAutomatic, true);
    EXPECT_EQ(first.used, InitialGuess::kChordal) << first.summary;
    ASSERT_EQ(first.candidates.size(), 3u);
    EXPECT_EQ(first.candidates[1].guess, InitialGuess::kFile);
    EXPECT_NE(first.summary.find("of the costs chordal"), std::string::npos) << first.summary;

    city.graph.SetValues(Solve(city.graph).values);
    const Values solved = city.graph.InitialValues();
    const InitialiseReport again = Initialise(&city.graph, InitialGuess::kAutomatic, true);
    EXPECT_EQ(again.used, InitialGuess::kFile) << again.summary;
    EXPECT_EQ(again.set, 0u);
    EXPECT_EQ(city.graph.InitialValues().Data(), solved.Data());
  }
}

TEST(Initialise, LeavesFactorsThatNobodyKnowsToTheSolver) {
  Simulated city = SimulateCity(Builtins());
  city.graph.DeclareFactorType("sonar/1", "pose:se2/1 | x:m");
  city.graph.Add(Factor{"sonar/1", {Key("robot1:0")}, {1}, kNoise, Loss{}, ""});
  const Values before = city.graph.InitialValues();
  EXPECT_EQ(Initialise(&city.graph, InitialGuess::kAutomatic, true).used, InitialGuess::kFile);
  EXPECT_EQ(city.graph.InitialValues().Data(), before.Data());
  EXPECT_EQ(Initialise(&city.graph, InitialGuess::kAutomatic, false).used,
            InitialGuess::kSpanningTree);
}

TEST(Initialise, LeavesBundlesAloneAndSaysSo) {
  Graph graph(Builtins());
  graph.Add(Key("camera:0"), "bal_camera/1", {0, 0, 0, 0, 0, -5, 500, 0, 0});
  graph.Add(Key("point:0"), "point3/1", {1, 2, 3});
  graph.Add(BalReprojectionFactor(Key("camera:0"), Key("point:0"), 1, 2, kNoise));
  const InitialiseReport report = Initialise(&graph, InitialGuess::kSpanningTree, false);
  EXPECT_EQ(report.set, 0u);
  EXPECT_NE(report.summary.find("no poses"), std::string::npos) << report.summary;
}

// A chain of four, each 1 m ahead of the last, with a shortcut that disagrees.
Graph Chain() {
  Graph graph(Builtins());
  for (std::uint64_t i = 0; i < 4; ++i) graph.Add(Key("pose", i), "se2/1", {0, 0, 0});
  for (std::uint64_t i = 0; i < 3; ++i)
    graph.Add(BetweenSe2Factor(Key("pose", i), Key("pose", i + 1), {1, 0, 0}, kNoise));
  graph.Add(BetweenSe2Factor(Key("pose:3"), Key("pose:0"), {-7, 0, 0}, kNoise, "loop"));
  return graph;
}

double X(const Graph& graph, const char* key) { return graph.ValueOf(graph.IdOf(Key(key)))[0]; }

TEST(Initialise, TakesTheFewestMeasurementsInATreeAndConsecutiveKeysInAChain) {
  Graph graph = Chain();
  Initialise(&graph, InitialGuess::kSpanningTree, false);
  EXPECT_EQ(X(graph, "pose:3"), 7);
  Initialise(&graph, InitialGuess::kOdometry, false);
  EXPECT_EQ(X(graph, "pose:3"), 3);
}

TEST(Initialise, TakesTheMostCertainMeasurementsInAMinimumSpanningTree) {
  Graph graph = Chain();  // the loop is as certain as the chain: nearest to the root counts
  Initialise(&graph, InitialGuess::kMinimumSpanningTree, false);
  EXPECT_EQ(X(graph, "pose:3"), 7);
  // Another way from 2 to 3, more certain than any: taken as soon as 3 is there.
  graph.Add(BetweenSe2Factor(Key("pose:2"), Key("pose:3"), {1.5, 0, 0}, Noise::Sigma(0.01)));
  Initialise(&graph, InitialGuess::kMinimumSpanningTree, false);
  EXPECT_EQ(X(graph, "pose:3"), 7);
  EXPECT_EQ(X(graph, "pose:2"), 5.5);
}

TEST(Initialise, BeginsAtFixedPosesAndPriorsElseAtTheSmallestKeyOfEachPiece) {
  Graph graph = Chain();
  graph.SetValue(graph.IdOf(Key("pose:0")), std::vector<double>{100, 0, 0});
  InitialiseReport report = Initialise(&graph, InitialGuess::kOdometry, false);
  EXPECT_EQ(report.free_roots, 1u);
  EXPECT_EQ(X(graph, "pose:3"), 103);

  graph.Add(PriorSe2Factor(Key("pose:2"), {20, 0, 0}, kNoise));
  report = Initialise(&graph, InitialGuess::kOdometry, false);
  EXPECT_EQ(report.free_roots, 0u);
  EXPECT_EQ(report.poses, 4u);
  EXPECT_EQ(X(graph, "pose:0"), 18);
  EXPECT_EQ(X(graph, "pose:3"), 21);

  graph.SetValue(graph.IdOf(Key("pose:3")), std::vector<double>{50, 0, 0});
  graph.SetFixed(graph.IdOf(Key("pose:3")), true);
  report = Initialise(&graph, InitialGuess::kOdometry, false);
  EXPECT_EQ(report.roots, 2u);
  EXPECT_EQ(X(graph, "pose:3"), 50);
  EXPECT_EQ(X(graph, "pose:2"), 20);

  Graph pieces(Builtins());
  pieces.Add(Key("pose:5"), "se2/1", {0, 0, 0});
  pieces.Add(Key("pose:4"), "se2/1", {3, 0, 0});
  pieces.Add(BetweenSe2Factor(Key("pose:5"), Key("pose:4"), {1, 0, 0}, kNoise));
  EXPECT_EQ(Initialise(&pieces, InitialGuess::kSpanningTree, false).free_roots, 1u);
  EXPECT_EQ(X(pieces, "pose:4"), 3);
  EXPECT_EQ(X(pieces, "pose:5"), 2);
}

TEST(Initialise, UndoesTheOffsetOfAPriorAndOfASensor) {
  // The sensor sits 1 m above the body and looks back; it is at (5, 0, 1), unturned.
  Graph graph(Builtins());
  graph.Add(Key("pose:0"), "se3/1", {0, 0, 0, 0, 0, 0, 1});
  graph.Add(Key("point:0"), "point3/1", {0, 0, 0});
  Factor prior{"prior_offset_se3/1", {Key("pose:0")}, {}, kNoise, Loss{}, ""};
  prior.measurement = {5, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0};
  graph.Add(prior);
  Factor sight{"landmark_offset_se3/1", {Key("pose:0"), Key("point:0")}, {}, kNoise, Loss{}, ""};
  sight.measurement = {2, 0, 0, 0, 0, 1, 0, 0, 1, 0};
  graph.Add(sight);
  Initialise(&graph, InitialGuess::kSpanningTree, false);
  const auto pose = graph.ValueOf(0), point = graph.ValueOf(1);
  const double expected_pose[7] = {5, 0, 0, 0, 0, 1, 0};
  const double sign = pose[5] < 0 ? -1 : 1;
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR((i < 3 ? 1 : sign) * pose[i], expected_pose[i], 1e-15);
  const double expected_point[3] = {7, 0, 1};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(point[i], expected_point[i], 1e-14);
}

// Two poses on the x axis, 2 m apart; the landmark is at (1, 1).
struct Sightings {
  Graph graph{Builtins()};
  Sightings() {
    graph.Add(Key("pose:0"), "se2/1", {0, 0, 0}, true);
    graph.Add(Key("pose:1"), "se2/1", {2, 0, 0}, true);
    graph.Add(Key("point:0"), "point2/1", {0, 0});
  }
  void See(const char* type, std::uint64_t pose, std::vector<double> measured) {
    graph.Add(Factor{type, {Key("pose", pose), Key("point:0")}, measured, kNoise, Loss{}, ""});
  }
  InitialiseReport Place() { return Initialise(&graph, InitialGuess::kSpanningTree, false); }
  void Expect(double x, double y) const {
    EXPECT_NEAR(graph.ValueOf(2)[0], x, 1e-14);
    EXPECT_NEAR(graph.ValueOf(2)[1], y, 1e-14);
  }
};

TEST(Initialise, PlacesALandmarkFromWhateverIsKnownOfIt) {
  Sightings bearing_range;
  bearing_range.See("bearing_range_se2/1", 1, {3 * M_PI / 4, std::sqrt(2)});
  EXPECT_EQ(bearing_range.Place().assumed, 0u);
  bearing_range.Expect(1, 1);

  Sightings crossing;
  crossing.See("bearing_se2/1", 0, {M_PI / 4});
  crossing.See("bearing_se2/1", 1, {3 * M_PI / 4});
  EXPECT_EQ(crossing.Place().assumed, 0u);
  crossing.Expect(1, 1);

  Sightings late;  // a full sighting counts for more than bearings before it
  late.See("bearing_se2/1", 0, {M_PI / 3});
  late.See("landmark_se2/1", 1, {-1, 1});
  EXPECT_EQ(late.Place().assumed, 0u);
  late.Expect(1, 1);

  Sightings one;
  one.See("bearing_se2/1", 0, {M_PI / 2});
  const InitialiseReport report = one.Place();
  EXPECT_EQ(report.assumed, 1u);
  EXPECT_NE(report.summary.find("assumed"), std::string::npos);
  one.Expect(0, 10);

  Sightings with_range;
  with_range.See("bearing_se2/1", 0, {M_PI / 2});
  with_range.See("range_se2/1", 0, {4});
  with_range.Place();
  with_range.Expect(0, 4);

  Sightings range;
  range.See("range_se2/1", 1, {3});
  EXPECT_EQ(range.Place().assumed, 1u);
  range.Expect(5, 0);
}

TEST(Initialise, IgnoresRaysThatCrossBehindOrHardlyAtAll) {
  Sightings apart;
  apart.See("bearing_se2/1", 0, {3 * M_PI / 4});
  apart.See("bearing_se2/1", 1, {M_PI / 4});
  EXPECT_EQ(apart.Place().assumed, 1u);
  Sightings parallel;
  parallel.See("bearing_se2/1", 0, {0.01});
  parallel.See("bearing_se2/1", 1, {0.02});
  EXPECT_EQ(parallel.Place().assumed, 1u);
}

TEST(InitialiseOptionTable, ReadsWhatItWrites) {
  const OptionRow<InitialiseOptions>& row = InitialiseOptionTable().at(0);
  EXPECT_EQ(row.name, "initialise");
  for (const char* name : {"automatic", "file", "odometry", "spanning_tree",
                           "minimum_spanning_tree", "chordal", "lago"}) {
    InitialiseOptions options;
    EXPECT_TRUE(row.set(options, name));
    EXPECT_EQ(row.get(options), name);
    EXPECT_NE(row.accepts.find(name), std::string::npos);
  }
  InitialiseOptions options;
  EXPECT_THROW(SetOption(InitialiseOptionTable(), "initialise", "spaning_tree", &options), Error);
}

}  // namespace
}  // namespace graticule
