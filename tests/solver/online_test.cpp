// A graph solved as it grows, against the same graph solved at once.

#include "graticule/solver/online.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "expect_error.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/solve.hpp"
#include "online_replay.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Numbers;
using testing::ObjectiveOf;
using testing::Replay;
using testing::Se2Loop;
using testing::Se3Loop;
using testing::TestTypes;
using testing::WithChords;

TEST(Online, WithoutShortCutsFollowsGaussNewtonToTheMinimum) {
  for (const bool planar : {true, false}) {
    const Graph graph =
        planar ? WithChords(Se2Loop(60, 0.02, 0.02), true) : Se3Loop(40, 0.02, 0.02);
    Online online(TestTypes(), testing::WithoutShortCuts());
    Replay(graph, &online);
    for (int i = 0; i < 10; ++i) online.Update();
    SolveOptions to;
    to.function_tolerance = 1e-15;
    const Solution batch = Solve(online.Problem(), to);
    const double objective = ObjectiveOf(online.Problem(), *online.Latest());
    EXPECT_NEAR(objective, batch.report.final_objective, 1e-9 * objective);
  }
}

TEST(Online, StaysNearTheMinimumAndReachesItWhereAsked) {
  const Graph graph = WithChords(Se2Loop(200, 0.02, 0.02), true);
  Online online(TestTypes());
  std::size_t exact = 0;
  Replay(graph, &online, [&](VariableId id, const OnlineReport& report) {
    EXPECT_EQ(report.new_variables, 1u);
    if (id % 40 != 39) return;
    const Graph problem = online.Problem();
    const double near = ObjectiveOf(problem, *online.Latest());
    const double batch = Solve(problem).report.final_objective;
    EXPECT_LE(near, 1.05 * batch + 0.01);
    const OnlineReport there = online.UpdateExactly();
    EXPECT_NEAR(there.objective, batch, 1e-6 * batch + 1e-12);
    EXPECT_NEAR(ObjectiveOf(problem, *online.Latest()), batch, 1e-6 * batch + 1e-12);
    ++exact;
  });
  EXPECT_EQ(exact, 5u);
}

TEST(Online, TouchesOnlyWhatChanges) {
  const Graph graph = Se2Loop(300, 0.02, 0.0);  // the loop closes with the last pose
  OnlineOptions options;
  options.relinearise_above = 1e9;
  Online online(TestTypes(), options);
  Replay(graph, &online, [&](VariableId id, const OnlineReport& report) {
    if (id + 1 < 300)
      EXPECT_LE(report.eliminated, 3u) << "an odometry step, at " << id;
    else
      EXPECT_GT(report.changed, 3u);
  });
}

TEST(Online, FollowsSmallChangesThatAddUp) {
  const OnlineOptions options;
  Online online(TestTypes(), options);
  online.Add(Key("pose:0"), "se2/1", {0, 0, 0});
  online.Add({"prior_se2/1", {Key("pose:0")}, {0, 0, 0}, Noise::Sigma(0.1), {}, ""});
  for (unsigned i = 1; i <= 3; ++i) {
    online.Add(Key("pose", i), "se2/1", {1.0 * i, 0, 0});
    online.Add(BetweenSe2Factor(Key("pose:0"), Key("pose", i), {1.0 * i, 0, 0}, Noise::Sigma(1e-3),
                                "stiff"));
  }
  online.Update();
  // Each moves pose:0 by less than is followed, all together by 5 mm.
  for (int i = 0; i < 100; ++i) {
    online.Add({"prior_se2/1", {Key("pose:0")}, {0.0099, 0, 0}, Noise::Sigma(1), {}, ""});
    online.Update();
  }
  for (unsigned i = 0; i <= 3; ++i)
    EXPECT_NEAR(online.Latest()->At(Key("pose", i))[0], i + 0.0099 / 2,
                options.propagate_above + 1e-9)
        << i;
}

TEST(Online, KnowsTheCovarianceThatMarginalsKnow) {
  const Graph graph = WithChords(Se2Loop(50, 0.02, 0.02), true);
  Online online(TestTypes());
  Replay(graph, &online);
  online.UpdateExactly();
  const Graph problem = online.Problem();
  std::vector<Key> keys;
  for (VariableId id = 0; id < 50; ++id) keys.push_back(problem.KeyOf(id));
  const auto found = ComputeMarginals(problem, *online.Latest(), keys, false);
  const auto& marginals = std::get<Marginals>(found);
  for (const Key& key : keys) {
    const std::vector<double> expected = marginals.Covariance(key, key);
    const std::vector<double> covariance = online.Covariance(key);
    ASSERT_EQ(covariance.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(covariance[i], expected[i], 1e-9) << key.ToString();
  }
}

TEST(Online, LetsGoOfItsAnchorWhereAPriorComesLate) {
  const Graph graph = Se2Loop(30, 0.02, 0.02);
  Online online(TestTypes());
  Replay(graph, &online);
  EXPECT_EQ(online.Covariance(Key("pose:0")), Numbers(9, 0.0));
  Factor prior{"prior_se2/1", {Key("pose:20")}, {100, 50, 1}, Noise::Sigma(0.1), {}, "gnss"};
  online.Add(prior);
  online.Update();
  EXPECT_GT(online.Covariance(Key("pose:0"))[0], 0.001);
  online.UpdateExactly();
  EXPECT_NEAR(online.Latest()->At(Key("pose:20"))[0], 100, 1e-3);
  EXPECT_NEAR(online.Latest()->At(Key("pose:20"))[1], 50, 1e-3);
}

TEST(Online, HoldsWhatNothingDeterminesUntilSomethingDoes) {
  Online online(TestTypes());
  online.Add(Key("a:0"), "se2/1", {0, 0, 0});
  online.Update();
  // Another robot, not yet met.
  online.Add(Key("b:0"), "se2/1", {7, 8, 1});
  online.Add(Key("b:1"), "se2/1", {8, 8, 1});
  online.Add(BetweenSe2Factor(Key("b:0"), Key("b:1"), {1, 0, 0}, Noise::Sigma(0.1), "odometry"));
  const OnlineReport loose = online.Update();
  EXPECT_FALSE(loose.loose.empty());
  for (const Key& key : loose.loose) EXPECT_EQ(key.Family(), "b");
  EXPECT_NEAR(online.Latest()->At(Key("b:0"))[0], 7, 1);
  online.Add(BetweenSe2Factor(Key("a:0"), Key("b:0"), {2, 3, 0.5}, Noise::Sigma(0.1), "meeting"));
  EXPECT_TRUE(online.Update().loose.empty());
  online.UpdateExactly();
  EXPECT_NEAR(online.Latest()->At(Key("b:0"))[0], 2, 1e-6);
  EXPECT_NEAR(online.Latest()->At(Key("b:1"))[0], 2 + std::cos(0.5), 1e-6);
}

TEST(Online, GivesNoCovarianceOfWhatNothingDetermines) {
  Online online(TestTypes());
  online.Add(Key("a:0"), "se2/1", {0, 0, 0}, true);
  for (unsigned i = 1; i < 4; ++i) {
    online.Add(Key("a", i), "se2/1", {1.0 * i, 0, 0});
    online.Add(BetweenSe2Factor(Key("a", i - 1), Key("a", i), {1, 0, 0}, Noise::Sigma(0.1)));
  }
  for (unsigned i = 0; i < 3; ++i) {  // another robot, not yet met
    online.Add(Key("b", i), "se2/1", {1.0 * i, 5, 0});
    if (i) online.Add(BetweenSe2Factor(Key("b", i - 1), Key("b", i), {1, 0, 0}, Noise::Sigma(0.1)));
  }
  const std::vector<Key> loose = online.Update().loose;
  ASSERT_EQ(loose.size(), 1u) << "stands for all";
  EXPECT_EQ(loose[0].Family(), "b");
  for (const char* key : {"b:0", "b:1", "b:2"})
    ExpectError(ErrorKind::kIllPosed, {key, loose[0].ToString()},
                [&] { online.Covariance(Key(key)); });
  const Numbers known = online.Covariance(Key("a:3"));
  EXPECT_NEAR(known[0], 0.03, 1e-12);

  // A landmark with one bearing: loose, what sees it is not.
  online.Add(Key("tree:0"), "point2/1", {3, 3});
  online.Add(
      {"bearing_se2/1", {Key("a:3"), Key("tree:0")}, {std::acos(0.0)}, Noise::Sigma(0.01), {}, ""});
  EXPECT_EQ(online.Update().loose, std::vector<Key>{Key("tree:0")});
  ExpectError(ErrorKind::kIllPosed, {"tree:0"}, [&] { online.Covariance(Key("tree:0")); });
  const Numbers still = online.Covariance(Key("a:3"));
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(still[i], known[i], 1e-12);

  online.Add(BetweenSe2Factor(Key("a:3"), Key("b:0"), {0, 5, 0}, Noise::Sigma(0.1), "meeting"));
  online.Update();
  EXPECT_NEAR(online.Covariance(Key("b:0"))[8], 0.04, 1e-12) << "yaw, over four factors";
}

TEST(Online, RefusesOptionsOutOfTheirRange) {
  const auto refuse = [](const char* name, void (*bend)(OnlineOptions*)) {
    OnlineOptions options;
    bend(&options);
    ExpectError(ErrorKind::kUsage, {name}, [&] { Online(TestTypes(), options); });
  };
  refuse("relinearise_every", [](OnlineOptions* o) { o->relinearise_every = 0; });
  refuse("relinearise_above", [](OnlineOptions* o) { o->relinearise_above = -1; });
  refuse("propagate_above", [](OnlineOptions* o) { o->propagate_above = std::nan(""); });
}

TEST(Online, SaysHowAnExactUpdateEnded) {
  const Graph graph = WithChords(Se2Loop(60, 0.02, 0.2), true);
  OnlineOptions options;
  options.relinearise_above = 1e9;
  options.solve.max_iterations = 1;
  Online online(TestTypes(), options);
  Replay(graph, &online);
  const OnlineReport cut_short = online.UpdateExactly();
  EXPECT_EQ(cut_short.termination, Termination::kNoConvergence);
  EXPECT_NE(cut_short.message, "");
  options.solve.max_iterations = 100;
  Online whole(TestTypes(), options);
  Replay(graph, &whole);
  EXPECT_EQ(whole.UpdateExactly().termination, Termination::kConverged);
}

TEST(Online, FreezesAPartOfTheMap) {
  const Graph graph = WithChords(Se2Loop(60, 0.02, 0.02), true);
  Online online(TestTypes());
  std::vector<Numbers> frozen;
  Replay(graph, &online, [&](VariableId id, const OnlineReport&) {
    if (id != 29) return;
    std::vector<Key> keys;
    for (unsigned i = 0; i < 20; ++i) keys.push_back(Key("pose", i));
    const auto before = online.Latest();
    for (const Key& key : keys) frozen.emplace_back(before->At(key).begin(), before->At(key).end());
    online.Freeze(keys);
  });
  online.UpdateExactly();
  for (unsigned i = 0; i < 20; ++i) {
    const Span<const double> value = online.Latest()->At(Key("pose", i));
    EXPECT_EQ(Numbers(value.begin(), value.end()), frozen[i]);
    EXPECT_EQ(online.Covariance(Key("pose", i)), Numbers(9, 0.0));
  }
  const Graph problem = online.Problem();
  EXPECT_TRUE(problem.IsFixed(problem.IdOf(Key("pose:7"))));
  const double batch = Solve(problem).report.final_objective;
  EXPECT_NEAR(ObjectiveOf(problem, *online.Latest()), batch, 1e-6 * batch);
}

TEST(Online, GivesTheSameDigitsEachTime) {
  const Graph graph = WithChords(Se2Loop(120, 0.02, 0.05), true);
  Online first(TestTypes()), second(TestTypes());
  Replay(graph, &first);
  Replay(graph, &second);
  EXPECT_EQ(first.Latest()->Data(), second.Latest()->Data());
}

TEST(Online, IsReadWhileItIsUpdated) {
  const Graph graph = WithChords(Se2Loop(200, 0.02, 0.02), true);
  Online online(TestTypes());
  EXPECT_EQ(online.Latest(), nullptr);
  std::atomic<bool> done{false};
  std::size_t seen = 0, reads = 0;
  std::thread reader([&] {
    while (!done) {
      const auto latest = online.Latest();
      if (!latest) continue;
      EXPECT_GE(latest->Count(), seen) << "values never go back";
      seen = latest->Count();
      double sum = 0;
      for (VariableId id = 0; id < latest->Count(); ++id) sum += (*latest)[id][0];
      EXPECT_TRUE(std::isfinite(sum));
      EXPECT_TRUE(latest->Has(Key("pose:0")));
      ++reads;
    }
  });
  Replay(graph, &online);
  done = true;
  reader.join();
  EXPECT_GT(reads, 0u);
  EXPECT_EQ(online.Latest()->Count(), 200u);
}

TEST(Online, KeepsWhatItHasWhereAFactorCannotBeEvaluated) {
  Online online(TestTypes());
  online.Add(Key("x:0"), "vector1/1", {2});
  online.Add({"log/1", {Key("x:0")}, {0}, Noise::Unit(), {}, ""});
  online.UpdateExactly();
  EXPECT_NEAR(online.Latest()->At(Key("x:0"))[0], 1, 1e-6);
  online.Add(Key("x:1"), "vector1/1", {-1});
  online.Add({"log/1", {Key("x:1")}, {0}, Noise::Unit(), {}, ""});
  ExpectError(ErrorKind::kOther, {"log/1", "x:1"}, [&] { online.Update(); });
  EXPECT_NEAR(online.Latest()->At(Key("x:0"))[0], 1, 1e-6);
  EXPECT_FALSE(online.Latest()->Has(Key("x:1")));
  ExpectError(ErrorKind::kInput, {"x:7"}, [&] { online.Covariance(Key("x:7")); });
}

}  // namespace
}  // namespace graticule
