// Variables that leave a growing graph, against the same graph with all of them.

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "graticule/solver/check.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"
#include "online_replay.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Minimum;
using testing::Numbers;
using testing::ObjectiveOf;
using testing::Replay;
using testing::Se2Loop;
using testing::Se3Loop;
using testing::TestTypes;
using testing::WithChords;
using testing::WithoutShortCuts;

std::vector<Key> Keys(const char* family, unsigned begin, unsigned end) {
  std::vector<Key> keys;
  for (unsigned i = begin; i < end; ++i) keys.push_back(Key(family, i));
  return keys;
}

Numbers At(const Values& values, const Key& key) {
  return {values.At(key).begin(), values.At(key).end()};
}

void ExpectNear(const Numbers& a, const Numbers& b, double tolerance, const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << what;
}

// Values and covariances of `keys` are those of the whole problem, of which they are the minimum.
void ExpectAsIn(const Graph& whole, const std::vector<Key>& keys, const Online& online,
                double tolerance) {
  const Values minimum = Minimum(whole);
  const auto found = ComputeMarginals(whole, minimum, keys, false);
  const auto& marginals = std::get<Marginals>(found);
  for (const Key& key : keys) {
    ExpectNear(At(*online.Latest(), key), At(minimum, key), tolerance, key.ToString());
    ExpectNear(online.Covariance(key), marginals.Covariance(key, key), tolerance, key.ToString());
  }
}

// Vectors of two sizes in a chain, each joined to the next by more than enough random equations.
Graph LinearChain(unsigned count) {
  testing::Random random(11);
  Graph graph(TestTypes());
  for (unsigned i = 0; i < count; ++i) {
    graph.Add(Key("a", i), "vector2/1", {0, 0});
    graph.Add(Key("b", i), "vector3/1", {0, 0, 0});
  }
  const auto join = [&](unsigned a, unsigned b) {
    Factor factor{"linear/1", {Key("a", a), Key("b", b)}, {}, Noise::Sigma(0.5), {}, ""};
    for (int i = 0; i < 12; ++i) factor.measurement.push_back(testing::Gauss(&random, 1));
    graph.Add(factor);
  };
  for (unsigned i = 0; i < count; ++i)
    for (unsigned b : {i, i, i, i + 1, i + 1, i + 2})
      if (b < count) join(i, b);
  return graph;
}

TEST(OnlineMarginalise, LeavesALinearProblemAsItWas) {
  const Graph graph = LinearChain(12);
  OnlineOptions options;
  options.propagate_above = 0;
  Online online(TestTypes(), options);
  Replay(graph, &online, [&](VariableId id, const OnlineReport&) {
    if (id == 9) online.Marginalise({Key("a:1"), Key("b:0")});
    if (id == 15) online.Marginalise({Key("a:0"), Key("a:3"), Key("b:3"), Key("b:1")});
  });
  std::vector<Key> left = Keys("a", 4, 12);
  for (unsigned i = 4; i < 12; ++i) left.push_back(Key("b", i));
  left.push_back(Key("b:2"));
  ExpectAsIn(graph, left, online, 1e-9);
  online.UpdateExactly();
  ExpectAsIn(graph, left, online, 1e-9);
}

TEST(OnlineMarginalise, MakesAFixedLagSmootherExactWhereTheProblemIsLinear) {
  const Graph graph = LinearChain(20);
  OnlineOptions options;
  options.propagate_above = 0;
  options.lag = {{"a", 5}, {"b", 6}};
  Online online(TestTypes(), options);
  std::size_t left = 0;
  Replay(graph, &online, [&](VariableId, const OnlineReport& report) {
    left += report.marginalised;
    EXPECT_LE(report.eliminated, 13u);
  });
  EXPECT_EQ(left, 40u - 11u);
  std::vector<Key> kept = Keys("a", 15, 20);
  for (unsigned i = 14; i < 20; ++i) kept.push_back(Key("b", i));
  ExpectAsIn(graph, kept, online, 1e-9);
  EXPECT_EQ(online.Problem().VariableCount(), 11u);
  EXPECT_EQ(online.Recorded().VariableCount(), 40u);
  EXPECT_EQ(online.Recorded().FactorCount(), graph.FactorCount());
}

TEST(OnlineMarginalise, ChangesNothingWhereThePosesAre) {
  for (const bool planar : {true, false}) {
    const Graph graph =
        planar ? WithChords(Se2Loop(40, 0.02, 0.02), true) : Se3Loop(30, 0.02, 0.02);
    const char* family = planar ? "pose" : "body";
    Online online(TestTypes(), WithoutShortCuts());
    Replay(graph, &online);
    for (int i = 0; i < 10; ++i) online.Update();
    Graph whole = online.Problem();
    whole.SetFixed(0, true);
    const auto gone = Keys(family, 3, 17);
    const auto left_there = At(*online.Latest(), gone[2]);
    online.Marginalise(gone);
    online.Update();
    const auto count = static_cast<unsigned>(graph.VariableCount());
    ExpectAsIn(whole, Keys(family, 17, count), online, 1e-9);
    EXPECT_EQ(At(*online.Latest(), gone[2]), left_there);
    online.UpdateExactly();
    online.Update();  // the last digits, which Solve does not see
    ExpectAsIn(whole, Keys(family, 17, count), online, 1e-9);
    EXPECT_EQ(online.Problem().VariableCount(), count - 14);
    EXPECT_TRUE(online.Problem().IsFixed(0)) << "what holds the frame is fixed for good";
    EXPECT_EQ(At(*online.Latest(), gone[2]), left_there);
  }
}

// What is left is curved by the manifold: the tree's Gauss-Newton steps and Solve agree on where
// its minimum is, far from where it was linearised.
TEST(OnlineMarginalise, GoesOnToTheMinimumOfWhatIsLeft) {
  for (const bool planar : {true, false}) {
    const Graph graph = planar ? Se2Loop(20, 0.02, 0.02) : Se3Loop(20, 0.02, 0.02);
    const std::string family = planar ? "pose" : "body";
    Online online(TestTypes(), WithoutShortCuts());
    Replay(graph, &online);
    for (int i = 0; i < 6; ++i) online.Update();
    online.Marginalise(Keys(family.c_str(), 5, 8));
    online.Update();
    Numbers pulled = At(*online.Latest(), Key(family, 8));
    pulled[0] += 1;
    if (planar) pulled[2] += 0.4;
    Factor pull{planar ? "prior_se2/1" : "prior_se3/1",
                {Key(family, 8)},
                pulled,
                Noise::Sigma(0.01),
                {},
                "pull"};
    online.Add(pull);
    for (int i = 0; i < 40; ++i) online.Update();
    const Graph problem = online.Problem();
    for (const JacobianCheck& check : CheckJacobians(problem, problem.InitialValues()))
      EXPECT_EQ(check.wrong + check.failed, 0u) << check.type << " " << check.worst;
    const double at_steps_end = ObjectiveOf(problem, problem.InitialValues());
    SolveOptions to;
    to.function_tolerance = 1e-15;
    const double least = Solve(problem, to).report.final_objective;
    EXPECT_GT(least, 0.1) << "it is pulled";
    EXPECT_NEAR(at_steps_end, least, 1e-9 * least);
    EXPECT_NEAR(online.UpdateExactly().objective, least, 1e-9 * least);
  }
}

// Not exact any more, for every step linearises at another estimate: measured, values to 0.7 % of
// their standard deviations, variances to 1 %.
TEST(OnlineMarginalise, StaysNearTheBatchWhereSomethingAbsoluteIsMeasured) {
  Graph graph = WithChords(Se2Loop(200, 0.05, 0.05), true);
  const std::vector<Numbers> truth = testing::Circle(200);
  for (unsigned i = 0; i < 200; i += 10)
    graph.Add(Factor{"prior_se2/1", {Key("pose", i)}, truth[i], Noise::Sigma(0.5), {}, "gnss"});
  OnlineOptions options;
  options.lag["pose"] = 20;
  options.propagate_above = 1e-6;
  Online online(TestTypes(), options);
  std::vector<std::vector<FactorId>> arrivals(200);
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    VariableId last = 0;
    for (const VariableId variable : graph.VariablesOf(id)) last = std::max(last, variable);
    arrivals[last].push_back(id);
  }
  for (unsigned i = 0; i < 200; ++i) {
    online.Add(Key("pose", i), "se2/1", testing::ValueOf(graph, i));
    for (const FactorId id : arrivals[i]) {
      const Factor factor = graph.FactorRecord(id);
      bool is_reachable = true;
      for (const VariableId variable : graph.VariablesOf(id)) is_reachable &= variable + 19 >= i;
      if (is_reachable) online.Add(factor);
    }
    online.Update();
  }
  online.UpdateExactly();
  const Graph whole = online.Recorded();
  EXPECT_GT(whole.FactorCount(), 220u);
  const Values values = Solve(whole).values;
  const std::vector<Key> window = Keys("pose", 180, 200);
  const auto found = ComputeMarginals(whole, values, window, false);
  double worst_value = 0, worst_covariance = 0;
  for (const Key& key : window) {
    const Numbers expected = std::get<Marginals>(found).Covariance(key, key),
                  covariance = online.Covariance(key);
    for (std::size_t i = 0; i < 3; ++i) {
      const double variance = expected[4 * i];
      worst_value =
          std::max(worst_value,
                   std::abs(online.Latest()->At(key)[i] - values.At(key)[i]) / std::sqrt(variance));
      worst_covariance =
          std::max(worst_covariance, std::abs(covariance[4 * i] - variance) / variance);
    }
  }
  EXPECT_LT(worst_value, 0.05);
  EXPECT_LT(worst_covariance, 0.02);
}

TEST(OnlineMarginalise, KeepsLandmarksWherePosesLeave) {
  Online online(TestTypes(), [] {
    OnlineOptions options;
    options.lag["pose"] = 3;
    return options;
  }());
  Graph whole(TestTypes());
  const auto add = [&](const Key& key, const char* type, const Numbers& value) {
    online.Add(key, type, value);
    whole.Add(key, type, value);
  };
  const auto say = [&](const Factor& factor) {
    online.Add(factor);
    whole.Add(factor);
  };
  add(Key("pose:0"), "se2/1", {0, 0, 0});
  say(PriorSe2Factor(Key("pose:0"), {0, 0, 0}, Noise::Sigma(0.01)));
  add(Key("tree:0"), "point2/1", {2, 2});
  add(Key("tree:1"), "point2/1", {5, -2});
  for (unsigned i = 0; i < 10; ++i) {
    if (i > 0) {
      add(Key("pose", i), "se2/1", {1.0 * i, 0, 0});
      say(BetweenSe2Factor(Key("pose", i - 1), Key("pose", i), {1, 0, 0}, Noise::Sigma(0.1)));
    }
    say(LandmarkSe2Factor(Key("pose", i), Key("tree:0"), {2 - 1.0 * i, 2}, Noise::Sigma(0.1)));
    say(LandmarkSe2Factor(Key("pose", i), Key("tree:1"), {5 - 1.0 * i, -2}, Noise::Sigma(0.1)));
    online.Update();
  }
  EXPECT_EQ(online.Problem().VariableCount(), 5u);
  // Measured without noise, started at the answer: nothing moves, so all is as if nothing had left.
  ExpectAsIn(whole, {Key("tree:0"), Key("tree:1"), Key("pose:8"), Key("pose:9")}, online, 1e-9);
}

TEST(OnlineMarginalise, LetsGoOfWhatNothingDetermines) {
  Online online(TestTypes());
  online.Add(Key("pose:0"), "se2/1", {0, 0, 0});
  online.Add(Key("pose:1"), "se2/1", {1, 0, 0});
  online.Add(Key("tree:0"), "point2/1", {3, 4});
  online.Add(PriorSe2Factor(Key("pose:0"), {0, 0, 0}, Noise::Sigma(0.1)));
  online.Add(BetweenSe2Factor(Key("pose:0"), Key("pose:1"), {1, 0, 0}, Noise::Sigma(0.1)));
  online.Update();
  const Numbers before = online.Covariance(Key("pose:1"));
  online.Marginalise({Key("tree:0")});  // without a factor
  EXPECT_TRUE(online.Update().loose.empty());
  EXPECT_EQ(online.Problem().FactorCount(), 2u);
  online.Marginalise({Key("pose:0")});
  online.Update();
  ExpectNear(online.Covariance(Key("pose:1")), before, 1e-12, "pose:1");
}

TEST(OnlineMarginalise, TakesFixedAndFrozenVariablesToo) {
  Online online(TestTypes());
  online.Add(Key("pose:0"), "se2/1", {0, 0, 0}, true);
  for (unsigned i = 1; i < 6; ++i) {
    online.Add(Key("pose", i), "se2/1", {1.0 * i, 0.1, 0});
    online.Add(
        BetweenSe2Factor(Key("pose", i - 1), Key("pose", i), {1, 0, 0.1}, Noise::Sigma(0.1)));
  }
  online.UpdateExactly();
  const Numbers value = At(*online.Latest(), Key("pose:5")),
                covariance = online.Covariance(Key("pose:5"));
  online.Marginalise({Key("pose:0")});
  online.UpdateExactly();
  ExpectNear(At(*online.Latest(), Key("pose:5")), value, 1e-9, "value");
  ExpectNear(online.Covariance(Key("pose:5")), covariance, 1e-9, "covariance");
  online.Freeze({Key("pose:2")});
  online.Update();
  const Numbers after_freezing = online.Covariance(Key("pose:5"));
  EXPECT_LT(after_freezing[0], covariance[0]);
  online.Marginalise({Key("pose:1"), Key("pose:2")});
  online.Update();
  ExpectNear(online.Covariance(Key("pose:5")), after_freezing, 1e-12, "covariance");
}

TEST(OnlineMarginalise, SaysWhatCannotReachTheDepartedAnyMore) {
  const Graph graph = Se2Loop(12, 0.02, 0.0);
  OnlineOptions options;
  options.lag["pose"] = 4;
  Online online(TestTypes(), options);
  std::vector<FactorId> ids;
  for (unsigned i = 0; i < 11; ++i) {
    online.Add(Key("pose", i), "se2/1", testing::ValueOf(graph, i));
    if (i > 0) ids.push_back(online.Add(graph.FactorRecord(i - 1)));
    online.Update();
  }
  const auto loop = [&](unsigned a, unsigned b) {
    return online.Add(
        BetweenSe2Factor(Key("pose", a), Key("pose", b), {1, 0, 0}, Noise::Unit(), "loop"));
  };
  ExpectError(ErrorKind::kInput, {"between_se2/1", "pose:2", "marginalised", "lag"},
              [&] { loop(2, 10); });
  ExpectError(ErrorKind::kInput, {"pose:2", "marginalised"},
              [&] { online.Covariance(Key("pose:2")); });
  ExpectError(ErrorKind::kInput, {"pose:2", "marginalised"}, [&] {
    online.Marginalise({Key("pose:9"), Key("pose:2")});
  });
  ExpectError(ErrorKind::kInput, {"pose:3", "marginalised"},
              [&] { online.Freeze({Key("pose:3")}); });
  ExpectError(ErrorKind::kInput, {"pose:77"}, [&] { online.Marginalise({Key("pose:77")}); });
  EXPECT_TRUE(online.HasLeft(Key("pose:2")));
  EXPECT_FALSE(online.HasLeft(Key("pose:9")));
  ExpectError(ErrorKind::kInput, {"pose:77"}, [&] { online.HasLeft(Key("pose:77")); });
  ExpectError(ErrorKind::kInput, {"pose:2", "there already"}, [&] {
    online.Add(Key("pose:2"), "se2/1", {0, 0, 0});
  });
  ExpectError(ErrorKind::kInput, {"factor 2", "pose:2", "pose:3", "marginalised"},
              [&] { online.Remove(ids[2]); });
  online.Add(Key("pose:11"), "se2/1", testing::ValueOf(graph, 11));
  ExpectError(ErrorKind::kInput, {"pose:11", "not in an update"},
              [&] { online.Marginalise({Key("pose:11")}); });
  const FactorId last = loop(10, 11);
  ExpectError(ErrorKind::kInput, {"pose:10", "not in an update"},
              [&] { online.Marginalise({Key("pose:10")}); });
  online.Remove(last);
  online.Marginalise({Key("pose:10")});
  online.Update();
  EXPECT_TRUE(online.Latest()->Has(Key("pose:2")));
}

TEST(OnlineMarginalise, WaitsWithWhatANewFactorTouches) {
  OnlineOptions options;
  options.lag["pose"] = 2;
  Online online(TestTypes(), options);
  const auto step = [&](unsigned i) {
    online.Add(Key("pose", i), "se2/1", {1.0 * i, 0, 0});
    if (i > 0)
      online.Add(
          BetweenSe2Factor(Key("pose", i - 1), Key("pose", i), {1, 0, 0}, Noise::Sigma(0.1)));
  };
  for (unsigned i = 0; i < 4; ++i) {
    step(i);
    online.Update();
  }
  const auto count = [&] { return online.Problem().VariableCount(); };
  EXPECT_EQ(count(), 2u);
  step(4);
  online.Add(BetweenSe2Factor(Key("pose:2"), Key("pose:4"), {2, 0, 0}, Noise::Sigma(0.1)));
  EXPECT_EQ(online.Update().marginalised, 0u);
  EXPECT_EQ(count(), 3u);
  EXPECT_EQ(online.Update().marginalised, 1u);
  EXPECT_EQ(count(), 2u);
}

TEST(OnlineMarginalise, GivesTheSameDigitsEachTime) {
  const Graph graph = WithChords(Se2Loop(120, 0.02, 0.05), true);
  Online first(TestTypes()), second(TestTypes());
  for (Online* online : {&first, &second}) {
    Replay(graph, online);
    online->Marginalise(Keys("pose", 10, 40));
    online->Update();
    online->Marginalise(Keys("pose", 60, 65));
    online->Freeze({Key("pose:66")});
    online->Remove(119);
    online->Update();
  }
  EXPECT_EQ(first.Latest()->Data(), second.Latest()->Data());
  EXPECT_EQ(first.UpdateExactly().objective, second.UpdateExactly().objective);
  EXPECT_EQ(first.Latest()->Data(), second.Latest()->Data());
}

}  // namespace
}  // namespace graticule
