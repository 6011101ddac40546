// Factors that are taken back, against the graph that never had them; and what readers keep.

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"
#include "online_replay.hpp"

namespace graticule {
namespace {

using testing::ExpectError;
using testing::Numbers;
using testing::ObjectiveOf;
using testing::Replay;
using testing::Se2Loop;
using testing::TestTypes;
using testing::WithChords;
using testing::WithoutShortCuts;

Factor FalseLoop(unsigned a, unsigned b) {
  return BetweenSe2Factor(Key("pose", a), Key("pose", b), {3, 1, 1}, Noise::Sigma(0.1), "false");
}

TEST(OnlineRemove, GivesWhatTheGraphWithoutItGives) {
  const Graph graph = WithChords(Se2Loop(60, 0.02, 0.02), true);
  Online online(TestTypes(), WithoutShortCuts());
  std::vector<FactorId> wrong;
  Replay(graph, &online, [&](VariableId id, const OnlineReport&) {
    if (id == 30) wrong.push_back(online.Add(FalseLoop(2, 25)));
    if (id == 45) wrong.push_back(online.Add(FalseLoop(40, 11)));
    if (id == 50) online.Remove(wrong[0]);
  });
  EXPECT_GT(ObjectiveOf(online.Problem(), *online.Latest()), 1);
  online.Remove(wrong[1]);
  const OnlineReport report = online.Update();
  EXPECT_GT(report.eliminated, 1u);
  for (int i = 0; i < 20; ++i) online.Update();
  Graph held = graph;
  held.SetFixed(0, true);
  const Values minimum = testing::Minimum(held);
  const auto same = [&] {
    for (VariableId id = 0; id < graph.VariableCount(); ++id)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR((*online.Latest())[id][i], minimum[id][i], 1e-9) << id;
  };
  same();
  const double objective = online.UpdateExactly().objective;
  EXPECT_NEAR(objective, ObjectiveOf(graph, minimum), 1e-9 * objective);
  online.Update();  // the last digits, which Solve does not see
  same();
  std::vector<Key> keys = {Key("pose:11"), Key("pose:25"), Key("pose:40")};
  const auto found = ComputeMarginals(graph, minimum, keys, false);
  for (const Key& key : keys) {
    const Numbers expected = std::get<Marginals>(found).Covariance(key, key);
    const Numbers covariance = online.Covariance(key);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(covariance[i], expected[i], 1e-9);
  }
  EXPECT_EQ(online.Problem().FactorCount(), graph.FactorCount());
  EXPECT_EQ(online.Recorded().FactorCount(), graph.FactorCount());
}

TEST(OnlineRemove, TouchesOnlyWhatTheFactorDid) {
  const Graph graph = Se2Loop(300, 0.02, 0.0);
  OnlineOptions options;
  options.relinearise_above = 1e9;
  Online online(TestTypes(), options);
  FactorId again = 0;
  Replay(graph, &online, [&](VariableId id, const OnlineReport&) {
    if (id == 200) again = online.Add(graph.FactorRecord(id - 5));
  });
  online.Update();
  online.Remove(again);
  EXPECT_LT(online.Update().eliminated, 150u);
}

TEST(OnlineRemove, KeepsIdsAndRefusesWhatIsNotThere) {
  const Graph graph = Se2Loop(10, 0.02, 0.0);
  Online online(TestTypes());
  Replay(graph, &online);
  const FactorId first = online.Add(FalseLoop(1, 5));
  EXPECT_EQ(first, 10u);
  online.Remove(first);  // before any update has seen it
  EXPECT_EQ(online.Update().new_factors, 0u);
  EXPECT_EQ(online.Add(FalseLoop(1, 6)), 11u);
  online.Update();
  ExpectError(ErrorKind::kInput, {"factor 10", "removed already"}, [&] { online.Remove(first); });
  ExpectError(ErrorKind::kInput, {"no factor 12", "12 have been added"},
              [&] { online.Remove(12); });
  online.Remove(11);
  online.UpdateExactly();
  EXPECT_EQ(online.Problem().FactorCount(), 10u);
  EXPECT_EQ(online.Add(FalseLoop(1, 7)), 12u);
}

TEST(OnlineRemove, HoldsTheFirstAgainWhereNothingElseSaysWhereTheGraphIs) {
  const Graph graph = Se2Loop(20, 0.02, 0.02);
  Online online(TestTypes());
  Replay(graph, &online);
  const FactorId fix = online.Add(
      Factor{"prior_se2/1", {Key("pose:10")}, {50, 40, 1}, Noise::Sigma(0.1), {}, "gnss"});
  online.Update();
  EXPECT_GT(online.Covariance(Key("pose:0"))[0], 0.001);
  online.Remove(fix);
  online.Update();
  EXPECT_EQ(online.Covariance(Key("pose:0")), Numbers(9, 0.0));
  EXPECT_TRUE(online.UpdateExactly().loose.empty());
}

TEST(OnlineRemove, NamesWhatComesLoose) {
  Online online(TestTypes());
  online.Add(Key("pose:0"), "se2/1", {0, 0, 0}, true);
  online.Add(Key("pose:1"), "se2/1", {1, 0, 0});
  const FactorId only =
      online.Add(BetweenSe2Factor(Key("pose:0"), Key("pose:1"), {1, 0, 0}, Noise::Unit()));
  EXPECT_TRUE(online.Update().loose.empty());
  online.Remove(only);
  EXPECT_EQ(online.Update().loose, std::vector<Key>{Key("pose:1")});
  EXPECT_NEAR(online.UpdateExactly().objective, 0, 1e-12);
  EXPECT_NEAR(online.Latest()->At(Key("pose:1"))[0], 1, 1e-6);
}

TEST(OnlineRemove, CuresAFactorThatCannotBeEvaluated) {
  Online online(TestTypes());
  online.Add(Key("x:0"), "vector1/1", {2});
  online.Add({"log/1", {Key("x:0")}, {0}, Noise::Unit(), {}, ""});
  online.Update();
  online.Add(Key("x:1"), "vector1/1", {-1});
  const FactorId bad = online.Add({"log/1", {Key("x:1")}, {0}, Noise::Unit(), {}, ""});
  online.Add({"limited/1", {Key("x:1")}, {-1, -5}, Noise::Unit(), {}, ""});
  ExpectError(ErrorKind::kOther, {"log/1", "x:1"}, [&] { online.Update(); });
  ExpectError(ErrorKind::kInput, {"last update failed"}, [&] { online.Marginalise({Key("x:0")}); });
  online.Remove(bad);
  online.Update();
  EXPECT_NEAR(online.Latest()->At(Key("x:1"))[0], -1, 1e-9);
  EXPECT_NEAR(online.UpdateExactly().objective, 0, 1e-9);
}

// Made once, as the graph looks at it; refuses ever after.
struct FickleFactor {
  static constexpr const char* kName = "fickle/1";
  static constexpr const char* kSchema = "x:vector1/1 | x | r";
  static constexpr const char* kSummary = "changes its mind";
  static int made;
  double x;
  explicit FickleFactor(Measurement m) : x(m[0]) {
    if (++made > 1) throw std::runtime_error("not again");
  }
  template <class T>
  bool operator()(const T* value, T* residual) const {
    residual[0] = value[0] - x;
    return true;
  }
};
int FickleFactor::made = 0;

TEST(OnlineRemove, CuresAFactorThatIsRefusedAtTheUpdate) {
  Registry types = TestTypes();
  types.Add(MakeFactorType(sdk::Table<FickleFactor>::kTable, "test"));
  FickleFactor::made = 0;
  Online online(types);
  online.Add(Key("x:0"), "vector1/1", {2});
  const FactorId bad = online.Add({"fickle/1", {Key("x:0")}, {1}, Noise::Sigma(0.1), {}, ""});
  online.Add({"log/1", {Key("x:0")}, {0}, Noise::Sigma(0.1), {}, ""});
  ExpectError(ErrorKind::kInput, {"fickle/1", "x:0", "not again"}, [&] { online.Update(); });
  online.Remove(bad);
  EXPECT_EQ(online.Update().new_factors, 1u);
  EXPECT_NEAR(online.UpdateExactly().objective, 0, 1e-9);
}

// Snapshots are brought up to date and given out again: never under a reader's hands.
TEST(OnlineSnapshots, StayAsTheyWereHoweverLongTheyAreHeld) {
  const Graph graph = WithChords(Se2Loop(150, 0.02, 0.02), true);
  std::vector<std::shared_ptr<const Values>> held;
  std::vector<Numbers> as_they_were;
  Values copy;
  Numbers copied;
  std::shared_ptr<const Values> last;
  {
    Online online(TestTypes());
    Replay(graph, &online, [&](VariableId id, const OnlineReport&) {
      EXPECT_EQ(online.Latest()->Count(), id + 1);
      if (id % 7 == 3) {
        held.push_back(online.Latest());
        as_they_were.push_back(held.back()->Data());
      }
      if (id % 11 == 0 && held.size() > 2) {
        held.erase(held.begin());
        as_they_were.erase(as_they_were.begin());
      }
      if (id == 60) {
        copy = *online.Latest();
        copied = copy.Data();
      }
    });
    last = online.Latest();
    const Graph problem = online.Problem();
    EXPECT_EQ(last->Data(), problem.InitialValues().Data()) << "nothing was missed on the way";
  }
  for (std::size_t i = 0; i < held.size(); ++i) {
    EXPECT_EQ(held[i]->Data(), as_they_were[i]);
    EXPECT_EQ(held[i]->Count() * 3, as_they_were[i].size());
    EXPECT_TRUE(held[i]->Has(Key("pose", held[i]->Count() - 1)));
    EXPECT_FALSE(held[i]->Has(Key("pose", held[i]->Count())));
  }
  EXPECT_EQ(copy.Data(), copied);
  EXPECT_EQ(copy.Count(), 61u);
  EXPECT_FALSE(copy.Has(Key("pose:61")));
  EXPECT_EQ(last->Count(), 150u) << "a reader may outlive what it reads from";
}

}  // namespace
}  // namespace graticule
