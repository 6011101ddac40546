#include "graticule/solver/diagnose.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "expect_error.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::Se2Loop;
using testing::TestTypes;

using Words = std::vector<std::string>;

Diagnosis DiagnoseAnchored(const Graph& graph) {
  return Diagnose(graph, graph.InitialValues(),
                  ChooseAnchors(graph, AnalyseStructure(graph), false));
}

TEST(Structure, FindsPiecesInTheOrderOfTheirKeys) {
  Graph graph = Se2Loop(3, 0, 0);
  graph.Add(Key("a:0"), "point2/1", {0, 0});
  graph.Add(Key("a:1"), "point2/1", {0, 0});
  graph.Add({"prior_point2/1", {Key("a:1")}, {0, 0}, Noise::Unit(), {}, ""});
  const Structure structure = AnalyseStructure(graph);
  ASSERT_EQ(structure.pieces.size(), 2u);
  EXPECT_EQ(graph.KeyOf(structure.pieces[0].first), Key("a:1"));
  EXPECT_EQ(structure.pieces[0].variables, 1u);
  EXPECT_FALSE(structure.pieces[0].IsLoose()) << "a prior holds it";
  EXPECT_EQ(structure.pieces[1].variables, 3u);
  EXPECT_EQ(structure.pieces[1].factors, 3u);
  EXPECT_TRUE(structure.pieces[1].IsLoose());
  ASSERT_EQ(structure.isolated.size(), 1u);
  EXPECT_EQ(graph.KeyOf(structure.isolated[0]), Key("a:0"));
}

TEST(Diagnosis, OfAWellPosedProblemIsEmpty) {
  EXPECT_EQ(DiagnoseAnchored(Se2Loop(20, 0.05, 0.1)).free_directions, 0u);
  EXPECT_EQ(DiagnoseAnchored(testing::Se3Loop(20, 0.02, 0.05)).free_directions, 0u);
}

TEST(Diagnosis, OfALongChainIsEmpty) {
  // The end of 2000 poses is known 1e7 times worse than a neighbour: far, and not free.
  Graph graph(TestTypes());
  for (unsigned i = 0; i < 2000; ++i) {
    graph.Add(Key("pose", i), "se2/1", {1.0 * i, 0, 0});
    if (i > 0)
      graph.Add(BetweenSe2Factor(Key("pose", i - 1), Key("pose", i), {1, 0, 0},
                                 Noise::Sigmas({0.05, 0.05, 0.01})));
  }
  const Diagnosis diagnosis = DiagnoseAnchored(graph);
  EXPECT_EQ(diagnosis.free_directions, 0u) << diagnosis.summary;
}

TEST(Diagnosis, NamesALandmarkThatWasSeenOnceByItsBearing) {
  Graph graph = Se2Loop(8, 0.01, 0.01);
  graph.Add(Key("landmark:4"), "point2/1", {50, 0});
  // pose:0 is at the origin and looks along x: the landmark is free along its line of sight, x.
  graph.Add({"bearing_se2/1", {Key("pose:0"), Key("landmark:4")}, {0}, Noise::Sigma(0.01), {}, ""});
  const Diagnosis diagnosis = DiagnoseAnchored(graph);
  EXPECT_EQ(diagnosis.free_directions, 1u);
  ASSERT_EQ(diagnosis.loose.size(), 1u) << diagnosis.summary;
  EXPECT_EQ(diagnosis.loose[0].key, Key("landmark:4"));
  EXPECT_EQ(diagnosis.loose[0].fields, (Words{"x"}));
  EXPECT_NEAR(diagnosis.loose[0].share, 1, 1e-6);
  EXPECT_NE(diagnosis.summary.find("landmark:4 along x"), std::string::npos) << diagnosis.summary;
}

TEST(Diagnosis, FindsTheGaugeOfAGraphThatNothingAnchors) {
  const Graph graph = Se2Loop(6, 0.01, 0.01);
  const Diagnosis diagnosis = Diagnose(graph, graph.InitialValues(), {});
  EXPECT_EQ(diagnosis.free_directions, 3u) << diagnosis.summary;
  EXPECT_EQ(diagnosis.loose.size(), 6u);
  EXPECT_NE(diagnosis.summary.find("all 6 variables"), std::string::npos) << diagnosis.summary;
}

TEST(Diagnosis, FindsTheYawThatAPositionLeavesFree) {
  Graph graph(TestTypes());
  graph.Add(Key("pose:0"), "se2/1", {3, 4, 0.5});
  graph.Add({"position_se2/1", {Key("pose:0")}, {3, 4}, Noise::Sigma(0.1), {}, "gnss"});
  const Diagnosis diagnosis = DiagnoseAnchored(graph);
  EXPECT_EQ(diagnosis.free_directions, 1u);
  ASSERT_EQ(diagnosis.loose.size(), 1u);
  EXPECT_EQ(diagnosis.loose[0].fields, (Words{"yaw"}));
}

TEST(Diagnosis, FindsComponentsThatNoInformationHolds) {
  Graph graph(TestTypes());
  graph.Add(Key("pose:0"), "se2/1", {0, 0, 0});
  graph.Add(
      {"prior_se2/1", {Key("pose:0")}, {0, 0, 0}, Noise::Information({4, 0, 0, 0, 0, 9}), {}, ""});
  const Diagnosis diagnosis = DiagnoseAnchored(graph);
  EXPECT_EQ(diagnosis.free_directions, 1u);
  ASSERT_EQ(diagnosis.loose.size(), 1u);
  EXPECT_EQ(diagnosis.loose[0].fields, (Words{"y"}));
}

// A random linear problem whose null space is known because it was put there.
TEST(Diagnosis, FindsAsManyDirectionsAsWerePlanted) {
  for (const unsigned planted : {1u, 2u, 5u, 6u, 7u, 13u}) {
    constexpr std::uint64_t kSeed = 12;
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", planted " + std::to_string(planted));
    testing::Random random(kSeed);
    Graph graph(TestTypes());
    for (unsigned i = 0; i < 20; ++i) {
      graph.Add(Key("a", i), "vector2/1", {0, 0});
      graph.Add(Key("b", i), "vector3/1", {0, 0, 0});
    }
    for (unsigned f = 0; f < 100; ++f) {
      const unsigned a = f % 20, b = (f + f / 20 * 3) % 20;
      testing::Numbers m(12);
      for (double& x : m) x = testing::Gauss(&random, 1);
      if (b < planted) m[6] = m[9] = 0;  // nothing minds b's last number
      graph.Add({"linear/1", {Key("a", a), Key("b", b)}, m, Noise::Sigma(0.1), {}, ""});
    }
    const Diagnosis diagnosis = DiagnoseAnchored(graph);
    EXPECT_EQ(diagnosis.free_directions, planted) << diagnosis.summary;
    EXPECT_FALSE(diagnosis.at_least);
    ASSERT_EQ(diagnosis.loose.size(), planted);
    for (const auto& loose : diagnosis.loose) {
      EXPECT_EQ(loose.key.Family(), "b");
      EXPECT_LT(loose.key.Number(), planted);
      EXPECT_EQ(loose.fields, (Words{"v2"}));
      EXPECT_NEAR(loose.share, 1.0 / planted, 1e-6);
    }
  }
}

TEST(Diagnosis, FindsADirectionThatIsSpreadOverTwoKeys) {
  // Only a0 + b0 is measured: a0 and b0 may move against each other.
  Graph graph(TestTypes());
  graph.Add(Key("a:0"), "vector2/1", {0, 0});
  graph.Add(Key("b:0"), "vector3/1", {0, 0, 0});
  graph.Add({"linear/1",
             {Key("a:0"), Key("b:0")},
             {1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0},
             Noise::Unit(),
             {},
             ""});
  graph.Add({"linear/1",
             {Key("a:0"), Key("b:0")},
             {0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0},
             Noise::Unit(),
             {},
             ""});
  const Diagnosis diagnosis = DiagnoseAnchored(graph);
  EXPECT_EQ(diagnosis.free_directions, 1u);
  ASSERT_EQ(diagnosis.loose.size(), 2u);
  EXPECT_EQ(diagnosis.loose[0].fields, (Words{"v0"}));
  EXPECT_EQ(diagnosis.loose[1].fields, (Words{"v0"}));
  EXPECT_NEAR(diagnosis.loose[0].share, 0.5, 1e-6);
}

TEST(Diagnosis, SaysAtLeastWhereThereAreMoreThanItLooksFor) {
  Graph graph(TestTypes());
  for (unsigned i = 0; i < 100; ++i) {
    graph.Add(Key("pose", i), "se2/1", {1.0 * i, 0, 0});
    graph.Add({"position_se2/1", {Key("pose", i)}, {1.0 * i, 0}, Noise::Sigma(0.1), {}, "gnss"});
  }
  const Diagnosis diagnosis = DiagnoseAnchored(graph);
  EXPECT_TRUE(diagnosis.at_least);
  EXPECT_GE(diagnosis.free_directions, 48u);
  EXPECT_NE(diagnosis.summary.find("at least"), std::string::npos);
}

TEST(Diagnosis, OfValuesOfAnotherGraphIsRefused) {
  const Graph graph = Se2Loop(6, 0.01, 0.01);
  testing::ExpectError(ErrorKind::kUsage, {"values"},
                       [&] { Diagnose(graph, Se2Loop(5, 0, 0).InitialValues(), {}); });
}

}  // namespace
}  // namespace graticule
