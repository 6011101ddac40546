#include "graticule/solver/marginals.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "expect_error.hpp"
#include "graticule/solver/solve.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Linearise;
using testing::Numbers;
using testing::Se2Loop;
using testing::Se3Loop;

std::vector<Key> AllKeys(const Graph& graph) {
  std::vector<Key> keys;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) keys.push_back(graph.KeyOf(id));
  return keys;
}

Marginals Compute(const Graph& graph, const Values& values, const std::vector<Key>& keys,
                  bool joint = false) {
  auto result = ComputeMarginals(graph, values, keys, joint);
  if (const auto* diagnosis = std::get_if<Diagnosis>(&result)) {
    ADD_FAILURE() << diagnosis->summary;
    return Marginals();
  }
  return std::get<Marginals>(result);
}

// Against the inverse of a dense J'J, J by central differences.
void ExpectDenseInverse(const Graph& graph, const Values& values) {
  const Marginals marginals = Compute(graph, values, AllKeys(graph), true);
  const testing::Dense dense = Linearise(graph, values, marginals.Anchors());
  const Eigen::MatrixXd inverse = (dense.jacobian.transpose() * dense.jacobian).inverse();
  const double scale = inverse.cwiseAbs().maxCoeff();
  for (VariableId a = 0; a < graph.VariableCount(); ++a)
    for (VariableId b = 0; b < graph.VariableCount(); ++b) {
      const int rows = graph.TypeOf(a).TangentSize(), columns = graph.TypeOf(b).TangentSize();
      const Numbers& block = marginals.Covariance(graph.KeyOf(a), graph.KeyOf(b));
      ASSERT_EQ(block.size(), static_cast<std::size_t>(rows * columns));
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
          const double found = block[static_cast<std::size_t>(r * columns + c)];
          if (dense.first[a] < 0 || dense.first[b] < 0) {
            EXPECT_EQ(found, 0) << "held";
          } else {
            // 1e-10 of a central difference, times the condition of about 1e3.
            EXPECT_NEAR(found, inverse(dense.first[a] + r, dense.first[b] + c), 1e-6 * scale)
                << graph.KeyOf(a).ToString() << " " << graph.KeyOf(b).ToString();
          }
        }
    }
}

TEST(Marginals, AreBlocksOfTheDenseInverse) {
  for (const Graph& graph : {Se2Loop(12, 0.05, 0.1), Se3Loop(10, 0.02, 0.05)})
    ExpectDenseInverse(graph, Solve(graph).values);
}

TEST(Marginals, AreBlocksOfTheDenseInverseAwayFromTheOptimum) {
  const Graph graph = Se2Loop(8, 0.05, 0.1);
  ExpectDenseInverse(graph, graph.InitialValues());
}

TEST(Marginals, CountAFactorByTheWeightThatItsLossLeaves) {
  Graph graph = Se2Loop(8, 0.3, 0.1);
  const Values values = Solve(graph).values;
  graph.SetLosses({LossKind::kHuber, 0.5});
  ExpectDenseInverse(graph, values);
  graph.SetLosses({LossKind::kCauchy, 1});
  ExpectDenseInverse(graph, values);
}

TEST(Marginals, TakeEveryKindOfNoise) {
  Graph graph = Se2Loop(6, 0.05, 0.1);
  graph.Add(BetweenSe2Factor(Key("pose:1"), Key("pose:4"), {1, 2, 3},
                             Noise::Information({4, 1, 0.5, 3, -0.5, 9})));
  graph.Add(BetweenSe2Factor(Key("pose:2"), Key("pose:5"), {1, 2, 3}, Noise::Unit()));
  ExpectDenseInverse(graph, Solve(graph).values);
}

TEST(Marginals, OfFixedVariablesAndAnchorsAreZero) {
  Graph graph = Se2Loop(6, 0.05, 0.1);
  Marginals marginals = Compute(graph, Solve(graph).values, AllKeys(graph));
  EXPECT_EQ(marginals.Anchors(), (std::vector<Key>{Key("pose:0")}));
  EXPECT_EQ(marginals.Covariance(Key("pose:0")), Numbers(9));
  graph.SetFixed(3, true);
  marginals = Compute(graph, Solve(graph).values, AllKeys(graph), true);
  EXPECT_TRUE(marginals.Anchors().empty());
  EXPECT_EQ(marginals.Covariance(Key("pose:3")), Numbers(9));
  EXPECT_EQ(marginals.Covariance(Key("pose:3"), Key("pose:1")), Numbers(9));
  EXPECT_GT(marginals.Covariance(Key("pose:0"))[0], 0);
}

TEST(Marginals, OfAllVariablesFixedAreZero) {
  Graph graph = Se2Loop(3, 0.05, 0.1);
  for (VariableId id = 0; id < 3; ++id) graph.SetFixed(id, true);
  EXPECT_EQ(Compute(graph, graph.InitialValues(), AllKeys(graph)).Covariance(Key("pose:1")),
            Numbers(9));
}

TEST(Marginals, GrowAlongAChainAsItsVariancesAdd) {
  // On a straight line without turning noise, x variances add: pose i has i sigma^2.
  Graph graph(testing::TestTypes());
  for (unsigned i = 0; i < 200; ++i) {
    graph.Add(Key("pose", i), "se2/1", {1.0 * i, 0, 0}, i == 0);
    if (i > 0)
      graph.Add(BetweenSe2Factor(Key("pose", i - 1), Key("pose", i), {1, 0, 0},
                                 Noise::Sigmas({0.1, 0.2, 0.01})));
  }
  const Marginals marginals = Compute(graph, graph.InitialValues(), AllKeys(graph));
  for (unsigned i = 1; i < 200; ++i) {
    const Numbers& block = marginals.Covariance(Key("pose", i));
    EXPECT_NEAR(block[0], 0.01 * i, 1e-9 * i);
    EXPECT_NEAR(block[8], 0.0001 * i, 1e-11 * i);
  }
}

// Many keys at once come from the inverse on the factor's pattern, few from solving for columns:
// two ways to the same numbers.
void ExpectAllAsOneByOne(const Graph& graph) {
  const Values values = Solve(graph).values;
  const Marginals all = Compute(graph, values, AllKeys(graph));
  for (VariableId id = 0; id < graph.VariableCount(); id += 7) {
    const Key& key = graph.KeyOf(id);
    const Numbers one = Compute(graph, values, {key}).Covariance(key);
    const Numbers& many = all.Covariance(key);
    ASSERT_EQ(many.size(), one.size());
    const double largest = *std::max_element(one.begin(), one.end());
    for (std::size_t i = 0; i < one.size(); ++i)
      EXPECT_NEAR(many[i], one[i], 1e-9 * largest) << key.ToString() << " entry " << i;
  }
}

TEST(Marginals, OfAllKeysAreThoseOfEachByItself) {
  ExpectAllAsOneByOne(Se2Loop(300, 0.05, 0.1));
  ExpectAllAsOneByOne(Se3Loop(100, 0.02, 0.05));
  // Closures everywhere: large supernodes.
  Graph graph = Se2Loop(200, 0.05, 0.1);
  for (unsigned i = 0; i < 200; ++i)
    graph.Add(BetweenSe2Factor(Key("pose", i), Key("pose", (37 * i + 11) % 200), {0.01 * i, 1, 0.1},
                               Noise::Sigmas({1, 2, 0.3})));
  ExpectAllAsOneByOne(graph);
}

TEST(Marginals, ThatWereNotAskedForAreAnError) {
  const Graph graph = Se2Loop(6, 0.05, 0.1);
  const Marginals marginals = Compute(graph, graph.InitialValues(), {Key("pose:1"), Key("pose:2")});
  ExpectError(ErrorKind::kInput, {"pose:3", "not asked for"},
              [&] { marginals.Covariance(Key("pose:3")); });
  ExpectError(ErrorKind::kInput, {"not asked for"},
              [&] { marginals.Covariance(Key("pose:1"), Key("pose:2")); });
  ExpectError(ErrorKind::kInput, {"pose:77"},
              [&] { ComputeMarginals(graph, graph.InitialValues(), {Key("pose:77")}); });
}

TEST(Marginals, OfAnIllPosedProblemAreADiagnosis) {
  Graph graph = Se2Loop(6, 0.05, 0.1);
  graph.Add(Key("landmark:0"), "point2/1", {3, 3});
  graph.Add(
      {"bearing_se2/1", {Key("pose:1"), Key("landmark:0")}, {0.5}, Noise::Sigma(0.1), {}, ""});
  const auto result = ComputeMarginals(graph, graph.InitialValues(), {Key("pose:1")});
  ASSERT_TRUE(std::holds_alternative<Diagnosis>(result));
  EXPECT_EQ(std::get<Diagnosis>(result).free_directions, 1u);
}

TEST(Marginals, OfValuesOfAnotherGraphAreRefused) {
  const Graph graph = Se2Loop(6, 0.05, 0.1);
  ExpectError(ErrorKind::kUsage, {"values"}, [&] {
    ComputeMarginals(graph, Se2Loop(5, 0.05, 0.1).InitialValues(), {Key("pose:1")});
  });
}

TEST(Marginals, SurviveScalesThatAreFarApart) {
  // Standard deviations from micrometres to kilometres beside each other.
  Graph graph(testing::TestTypes());
  graph.Add(Key("x:0"), "point2/1", {0, 0});
  graph.Add(Key("y:0"), "point2/1", {0, 0});
  graph.Add({"prior_point2/1", {Key("x:0")}, {0, 0}, Noise::Sigma(1e-6), {}, ""});
  graph.Add({"prior_point2/1", {Key("y:0")}, {0, 0}, Noise::Sigma(1e6), {}, ""});
  const Marginals marginals = Compute(graph, graph.InitialValues(), {Key("x:0"), Key("y:0")});
  EXPECT_NEAR(marginals.Covariance(Key("x:0"))[0], 1e-12, 1e-22);
  EXPECT_NEAR(marginals.Covariance(Key("y:0"))[0], 1e12, 1e2);
}

}  // namespace
}  // namespace graticule
