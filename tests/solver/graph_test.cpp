#include "graticule/solver/graph.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_error.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

const Key kA("pose:0"), kB("pose:1"), kC("pose:2"), kPoint("point:0");

Graph Small() {
  Graph graph(Builtins());
  graph.Add(kA, "se2/1", {0, 0, 0}, true);
  graph.Add(kB, "se2/1", {1, 0, 0});
  graph.Add(kPoint, "point2/1", {1, 1});
  graph.Add(BetweenSe2Factor(kA, kB, {1, 0, 0}, Noise::Sigma(0.1), "odometry"));
  return graph;
}

// All that a graph says of itself, as text.
std::string Describe(const Graph& graph) {
  std::string text;
  const auto number = [&](double value) { text += " " + std::to_string(value); };
  for (const VariableType& type : graph.UsedVariableTypes()) text += type.name + "\n";
  for (const FactorType& type : graph.UsedFactorTypes()) text += type.name + "\n";
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    text += graph.KeyOf(id).ToString() + " " + graph.TypeOf(id).name;
    for (const double value : graph.ValueOf(id)) number(value);
    text += graph.IsFixed(id) ? " fixed\n" : "\n";
  }
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const Factor factor = graph.FactorRecord(id);
    text += factor.type;
    for (const Key& key : factor.keys) text += " " + key.ToString();
    for (const double value : factor.measurement) number(value);
    text += " noise " + std::to_string(static_cast<int>(factor.noise.kind));
    for (const double value : factor.noise.values) number(value);
    text += " " + std::string(LossName(factor.loss.kind)) + " " + factor.source + "\n";
  }
  return text + std::to_string(graph.NoiseCount());
}

// A change that must be refused, and leave the graph as it was and still of use.
template <class Change>
void ExpectRefused(ErrorKind kind, const std::vector<std::string>& needles, Change&& change) {
  Graph graph = Small();
  const std::string before = Describe(graph);
  ExpectError(kind, needles, [&] { change(&graph); });
  EXPECT_EQ(Describe(graph), before);
  EXPECT_NO_THROW(graph.Add(kC, "se2/1", {2, 0, 0}));
  EXPECT_NO_THROW(graph.Add(BetweenSe2Factor(kB, kC, {1, 0, 0}, Noise::Sigma(0.1))));
}

TEST(Graph, GivesBackWhatWasAdded) {
  const Graph graph = Small();
  EXPECT_EQ(graph.VariableCount(), 3u);
  EXPECT_EQ(graph.FactorCount(), 1u);
  EXPECT_EQ(graph.IdOf(kB), 1u);
  EXPECT_EQ(graph.Find(kC), Layout::kNone);
  EXPECT_TRUE(graph.IsFixed(0));
  EXPECT_FALSE(graph.IsFixed(1));
  EXPECT_EQ(graph.TypeOf(2).name, "point2/1");
  const Factor factor = graph.FactorRecord(0);
  EXPECT_EQ(factor.type, "between_se2/1");
  EXPECT_EQ(factor.keys, (std::vector<Key>{kA, kB}));
  EXPECT_EQ(factor.measurement, (std::vector<double>{1, 0, 0}));
  EXPECT_EQ(factor.noise.kind, NoiseKind::kSigma);
  EXPECT_EQ(factor.source, "odometry");
  EXPECT_EQ(graph.ResidualSize(0), 3);
}

TEST(Graph, RefusesAVariableThatIsNotRight) {
  ExpectRefused(ErrorKind::kInput, {"pose:1", "is there already"}, [](Graph* g) {
    g->Add(kB, "se2/1", {0, 0, 0});
  });
  ExpectRefused(ErrorKind::kMissingType, {"se4/1", "not loaded", "did you mean"}, [](Graph* g) {
    g->Add(kC, "se4/1", {0, 0, 0});
  });
  ExpectRefused(ErrorKind::kInput, {"pose:2", "expected 3 numbers (x:m y:m yaw:rad), found 2"},
                [](Graph* g) {
                  g->Add(kC, "se2/1", {0, 0});
                });
  ExpectRefused(ErrorKind::kInput, {"pose:2", "finite"}, [](Graph* g) {
    g->Add(kC, "se2/1", {0, std::nan(""), 0});
  });
  ExpectRefused(ErrorKind::kInput, {"pose:2", "finite"}, [](Graph* g) {
    g->Add(kC, "se2/1", {HUGE_VAL, 0, 0});
  });
  ExpectRefused(ErrorKind::kInput, {"body:0", "not a se3/1"}, [](Graph* g) {
    g->Add(Key("body:0"), "se3/1", {0, 0, 0, 0, 0, 0, 2});
  });
}

TEST(Graph, RefusesAFactorThatIsNotRight) {
  const Factor good = BetweenSe2Factor(kA, kB, {1, 0, 0}, Noise::Sigma(0.2), "loop");
  const auto refuse = [&](ErrorKind kind, const std::vector<std::string>& needles,
                          void (*bend)(Factor*)) {
    Factor bent = good;
    bend(&bent);
    ExpectRefused(kind, needles, [&](Graph* g) { g->Add(bent); });
  };
  refuse(ErrorKind::kMissingType, {"between_se4/1 is not loaded", "did you mean 'between_se"},
         [](Factor* f) { f->type = "between_se4/1"; });
  refuse(ErrorKind::kInput, {"pose:7"}, [](Factor* f) { f->keys[1] = Key("pose:7"); });
  refuse(ErrorKind::kInput, {"expected se2/1 at point:0, which is point2/1"},
         [](Factor* f) { f->keys[1] = kPoint; });
  refuse(ErrorKind::kInput, {"expected 2 keys, found 1"}, [](Factor* f) { f->keys.pop_back(); });
  refuse(ErrorKind::kInput, {"expected 2 keys, found 3"},
         [](Factor* f) { f->keys.push_back(kPoint); });
  refuse(ErrorKind::kInput, {"expected 2 keys, found 0"}, [](Factor* f) { f->keys.clear(); });
  refuse(ErrorKind::kInput, {"same key twice"}, [](Factor* f) { f->keys[1] = kA; });
  refuse(ErrorKind::kInput, {"expected 3 measured numbers", "found 4"},
         [](Factor* f) { f->measurement.push_back(0); });
  refuse(ErrorKind::kInput, {"(pose:0 pose:1)", "finite"},
         [](Factor* f) { f->measurement[2] = std::nan(""); });
  refuse(ErrorKind::kInput, {"(pose:0 pose:1)", "standard deviations"}, [](Factor* f) {
    f->noise = Noise::Sigmas({1, 2});
  });
  refuse(ErrorKind::kInput, {"positive definite"}, [](Factor* f) {
    f->noise = Noise::Information({1, 2, 0, 1, 0, 1});
  });
  refuse(ErrorKind::kInput, {"loss scale above zero"}, [](Factor* f) {
    f->loss = {LossKind::kHuber, 0};
  });
  refuse(ErrorKind::kInput, {"loss scale above zero"}, [](Factor* f) {
    f->loss = {LossKind::kHuber, std::nan("")};
  });
}

TEST(Graph, RefusesAKeyThatIsTwiceAmongMany) {
  Graph graph(Builtins());
  Factor many{"gaussian/1", {}, {1, 54}, Noise::Unit(), {}, ""};
  for (unsigned i = 0; i < 17; ++i) {
    graph.Add(Key("pose", i), "se2/1", {0, 0, 0});
    many.keys.push_back(Key("pose", i));
  }
  many.keys.push_back(Key("pose:3"));
  many.measurement.resize(2 + 54 + 54 + 1, 0.0);
  ExpectError(ErrorKind::kInput, {"gaussian/1", "same key twice"}, [&] { graph.Add(many); });
  graph.Add(Key("pose:17"), "se2/1", {0, 0, 0});
  many.keys.back() = Key("pose:17");
  EXPECT_NO_THROW(graph.Add(many));
}

TEST(Graph, ReplacesLossesAndSourcesOfFactorsThatAreThere) {
  Graph graph = Small();
  graph.SetLoss(0, {LossKind::kCauchy, 2});
  graph.SetSource(0, "lidar");
  EXPECT_EQ(graph.FactorRecord(0).source, "lidar");
  const std::string before = Describe(graph);
  ExpectError(ErrorKind::kUsage, {"no factor 1", "has 1"}, [&] { graph.SetLoss(1, {}); });
  ExpectError(ErrorKind::kUsage, {"no factor 1", "has 1"}, [&] { graph.SetSource(1, "x"); });
  for (const double scale : {0.0, -1.0, std::nan(""), 1e-200}) {
    const Loss bad{LossKind::kHuber, scale};
    ExpectError(ErrorKind::kInput, {"loss scale above zero"}, [&] { graph.SetLoss(0, bad); });
    ExpectError(ErrorKind::kInput, {"loss scale above zero"}, [&] { graph.SetLosses(bad); });
  }
  EXPECT_EQ(Describe(graph), before);
  EXPECT_EQ(graph.LossOf(0), (Loss{LossKind::kCauchy, 2}));
}

TEST(Graph, ThatRefusesATypesFirstUseHasNotUsedIt) {
  // Files list the types in use: one that was only tried must not appear there.
  ExpectRefused(ErrorKind::kInput, {"expected 7 numbers"},
                [](Graph* g) { g->Add(Key("body:0"), "se3/1", {0}); });
  ExpectRefused(ErrorKind::kInput, {"expected se2/1 at point:0"}, [](Graph* g) {
    g->Add({"landmark_se2/1", {kPoint, kPoint}, {1, 1}, Noise::Unit(), {}, ""});
  });
  ExpectRefused(ErrorKind::kInput, {"expected se3/1"}, [](Graph* g) {
    g->Add({"landmark_se3/1", {kA, kB}, {1, 1, 1}, Noise::Unit(), {}, ""});
  });
}

TEST(Graph, NormalisesWhatIsNearItsManifold) {
  Graph graph(Builtins());
  graph.Add(Key("body:0"), "se3/1", {1, 2, 3, 0, 0, 0, 1.0004});
  EXPECT_EQ(graph.ValueOf(0)[6], 1);
}

TEST(Graph, KeepsEqualNoisesOnce) {
  Graph graph = Small();
  for (unsigned i = 2; i < 50; ++i) {
    graph.Add(Key("pose", i), "se2/1", {1.0 * i, 0, 0});
    graph.Add(BetweenSe2Factor(Key("pose", i - 1), Key("pose", i), {1, 0, 0}, Noise::Sigma(0.1)));
  }
  EXPECT_EQ(graph.NoiseCount(), 1u);
}

TEST(Graph, GivesThePositionsInTheOrderOfTheKeys) {
  const Graph graph = Small();
  EXPECT_EQ(graph.KeyOrder(), (std::vector<VariableId>{2, 0, 1}));
}

TEST(Graph, FindsNumbersFarOut) {
  Graph graph(Builtins());
  for (const std::uint64_t number : {std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{1} << 40})
    graph.Add(Key("pose", number), "se2/1", {1, 2, 0});
  EXPECT_EQ(graph.IdOf(Key("pose", ~std::uint64_t{0})), 1u);
  EXPECT_EQ(graph.Find(Key("pose", 1)), Layout::kNone);
}

TEST(Graph, CutsASlice) {
  Graph graph = Small();
  graph.Add(kC, "se2/1", {2, 0, 0});
  graph.Add(BetweenSe2Factor(kB, kC, {1, 0, 0}, Noise::Sigma(0.1), "odometry"));
  graph.Add(LandmarkSe2Factor(kC, kPoint, {1, 1}, Noise::Sigma(0.1), "camera"));
  const Graph slice = graph.Slice({kC, kPoint});
  EXPECT_EQ(slice.VariableCount(), 2u);
  ASSERT_EQ(slice.FactorCount(), 1u);
  EXPECT_EQ(slice.FactorRecord(0).source, "camera");
  EXPECT_EQ(graph.FactorCount(), 3u);
  EXPECT_TRUE(graph.Slice({kA}).IsFixed(0));
  EXPECT_EQ(graph.Slice({}).VariableCount(), 0u);
  ExpectError(ErrorKind::kInput, {"pose:9"}, [&] { graph.Slice({kA, Key("pose:9")}); });
  EXPECT_EQ(Describe(graph.Slice({kA, kB, kC, kPoint})), Describe(graph));
}

// --- values

TEST(Values, StayAsTheyWereWhenTheGraphGoesOn) {
  Graph graph = Small();
  const Values before = graph.InitialValues();
  graph.Add(kC, "se2/1", {5, 5, 0});
  const double moved[3] = {9, 9, 0};
  graph.SetValue(1, {moved, 3});
  EXPECT_EQ(before.Count(), 3u);
  EXPECT_FALSE(before.Has(kC));
  EXPECT_EQ(before.At(kB)[0], 1);
  EXPECT_EQ(graph.ValueOf(1)[0], 9);
  ExpectError(ErrorKind::kInput, {"pose:2"}, [&] { before.At(kC); });
}

TEST(Values, OfACopiedGraphAreItsOwn) {
  Graph graph = Small();
  Graph copy = graph;
  copy.Add(kC, "se2/1", {5, 5, 0});
  EXPECT_EQ(graph.VariableCount(), 3u);
  EXPECT_EQ(graph.Find(kC), Layout::kNone);
  graph.Add(Key("other:0"), "point2/1", {0, 0});
  EXPECT_EQ(copy.Find(Key("other:0")), Layout::kNone);
}

TEST(Values, OfAPartReplaceThatPart) {
  Graph graph = Small();
  Values part = graph.Slice({kB}).InitialValues();
  part.Mutable(0)[0] = 7;
  graph.SetValues(part);
  EXPECT_EQ(graph.ValueOf(graph.IdOf(kB))[0], 7);
  EXPECT_EQ(graph.ValueOf(graph.IdOf(kPoint))[0], 1);
}

TEST(Values, ThatAreRefusedReplaceNothing) {
  Graph graph = Small();
  const std::string before = Describe(graph);
  Values values = graph.InitialValues();
  values.Mutable(0)[0] = 3;
  values.Mutable(2)[1] = std::nan("");
  EXPECT_THROW(graph.SetValues(values), Error);
  EXPECT_EQ(Describe(graph), before);

  Graph other(Builtins());
  other.Add(kB, "se2/1", {7, 7, 0});
  other.Add(Key("stranger:0"), "point2/1", {0, 0});
  ExpectError(ErrorKind::kInput, {"stranger:0"}, [&] { graph.SetValues(other.InitialValues()); });
  EXPECT_EQ(Describe(graph), before);

  Graph wrong(Builtins());
  wrong.Add(kB, "se2/1", {7, 7, 0});
  wrong.Add(kPoint, "point3/1", {0, 0, 0});
  ExpectError(ErrorKind::kInput, {"point:0"}, [&] { graph.SetValues(wrong.InitialValues()); });
  EXPECT_EQ(Describe(graph), before);
}

// --- declared types

TEST(DeclaredType, CanBeAddedSlicedAndReadBack) {
  Graph graph(Builtins());
  graph.DeclareVariableType("spline/1", "a:m b:m c");
  graph.DeclareFactorType("knot/2", "s:spline/1 p:se2/1 | t:s | e:m");
  graph.Add(Key("spline:0"), "spline/1", {1, 2, 3});
  graph.Add(kA, "se2/1", {0, 0, 0});
  graph.Add({"knot/2", {Key("spline:0"), kA}, {0.5}, Noise::Sigma(0.1), {}, "fit"});
  EXPECT_FALSE(graph.FactorAt(0).type->Known());
  EXPECT_FALSE(graph.TypeOf(0).known);
  EXPECT_EQ(ToString(graph.FactorAt(0).type->schema), "s:spline/1 p:se2/1 | t:s | e:m");
  const Graph slice = graph.Slice({Key("spline:0"), kA});
  EXPECT_EQ(slice.FactorRecord(0).measurement, (std::vector<double>{0.5}));
  EXPECT_THROW(graph.Add({"knot/2", {kA, kA}, {0.5}, Noise::Unit(), {}, ""}), Error);
}

TEST(DeclaredType, MustAgreeWithAKnownOne) {
  Graph graph(Builtins());
  EXPECT_NO_THROW(graph.DeclareFactorType("between_se2/1", "a:se2/1 b:se2/1 | x:m y:m yaw:rad"));
  EXPECT_NO_THROW(graph.DeclareVariableType("se2/1", "x:m y:m yaw:rad"));
  ExpectError(ErrorKind::kInput, {"between_se2/1", "declared as"}, [&] {
    graph.DeclareFactorType("between_se2/1", "a:se2/1 b:se2/1 | x:m y:m yaw:deg");
  });
  ExpectError(ErrorKind::kInput, {"se2/1", "declared as"},
              [&] { graph.DeclareVariableType("se2/1", "x:cm y:cm yaw:rad"); });
  ExpectError(ErrorKind::kMissingType, {"klein_bottle/1"},
              [&] { graph.DeclareFactorType("mine/1", "a:klein_bottle/1 | x"); });
  ExpectError(ErrorKind::kInput, {"type name"},
              [&] { graph.DeclareFactorType("mine", "a:se2/1 | x"); });
}

}  // namespace
}  // namespace graticule
