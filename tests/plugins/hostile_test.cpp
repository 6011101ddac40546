// Plug-ins with something wrong.  None may end the process, and none that is refused may leave a
// trace in the registry.  Not shown: a plug-in that writes where it should not, which no host can
// survive.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "graticule/solver/check.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/solve.hpp"
#include "load.hpp"

namespace graticule {
namespace {

using testing::Names;
using testing::PluginFile;
using testing::With;

// The message of the refusal; "" where there is none.
std::string Refusal(const std::string& file, Registry* types) {
  try {
    LoadPlugin(file, types);
  } catch (const Error& error) {
    EXPECT_EQ(error.Kind(), ErrorKind::kMissingType) << error.what();
    return error.what();
  }
  return "";
}

struct Refused {
  const char* plugin;
  const char* because;
};

std::ostream& operator<<(std::ostream& out, const Refused& refused) {
  return out << refused.plugin;
}

class HostilePlugin : public ::testing::TestWithParam<Refused> {};

TEST_P(HostilePlugin, IsRefusedByItsFileAndTheReasonAndLeavesNothing) {
  Registry types = Builtins();
  const std::vector<std::string> before = Names(types);
  const std::string file = PluginFile(GetParam().plugin);
  const std::string message = Refusal(file, &types);
  EXPECT_NE(message.find(file), std::string::npos) << message;
  EXPECT_NE(message.find(GetParam().because), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << "one line: " << message;
  EXPECT_EQ(Names(types), before);
}

INSTANTIATE_TEST_SUITE_P(
    All, HostilePlugin,
    ::testing::Values(Refused{"throws_in_entry", "its entry threw: out of cheese"},
                      Refused{"wrong_abi", "it speaks version 2 of the boundary, this program 1"},
                      Refused{"short_plugin", "its table is too short for version 1"},
                      Refused{"null_plugin", "its entry returned nothing"},
                      Refused{"no_entry", "it has no symbol graticule_plugin_entry_v1"},
                      Refused{"takes_builtin_name", "is already taken, by built-in"},
                      Refused{"null_factor", "one of its factor types is null"},
                      Refused{"null_list", "its counts of types are not right"},
                      Refused{"negative_count", "its counts of types are not right"},
                      Refused{"null_variable", "one of its variable types is null"},
                      Refused{"null_function", "bent/1 lacks create, evaluate or destroy"},
                      Refused{"null_name", "its name is not of the form name/version"},
                      Refused{"short_table", "its table is too short for version 1"},
                      Refused{"bad_schema", "expected a block such as a:se2/1"},
                      Refused{"unknown_variable", "needs variable type klein_bottle/1"},
                      Refused{"half_variable", "half/1 has some of plus, plus_jacobian, minus"},
                      Refused{"second_of_two_is_bad", "its name is not of the form name/version"}),
    [](const auto& info) { return std::string(info.param.plugin); });

TEST(Plugin, ThatIsNoLibraryIsRefused) {
  const std::string file = ::testing::TempDir() + "not_a_library.so";
  std::ofstream(file) << "graticule-problem 1\n";
  Registry types = Builtins();
  const std::string message = Refusal(file, &types);
  EXPECT_NE(message.find(file), std::string::npos) << message;
  std::remove(file.c_str());
}

TEST(Plugin, ThatIsNotThereOrAFolderIsRefused) {
  Registry types = Builtins();
  for (const std::string file : {"/nowhere/libradar.so", PLUGIN_DIR, ""})
    EXPECT_NE(Refusal(file, &types).find("there is no such file"), std::string::npos) << file;
}

TEST(Plugin, WhoseFactorNameAnotherOneTookIsRefusedWithBothFiles) {
  Registry types = With({"straight"});
  const std::vector<std::string> before = Names(types);
  const std::string message = Refusal(PluginFile("nan_residual"), &types);  // bent/1 as well
  EXPECT_NE(message.find(PluginFile("straight")), std::string::npos) << message;
  EXPECT_NE(message.find(PluginFile("nan_residual")), std::string::npos) << message;
  EXPECT_EQ(Names(types), before);
  EXPECT_EQ(types.FindFactorType("bent/1")->origin, PluginFile("straight"));
}

TEST(Plugin, LoadedTwiceIsRefusedTheSecondTime) {
  Registry types = With({"straight"});
  EXPECT_NE(Refusal(PluginFile("straight"), &types).find("already taken"), std::string::npos);
}

// --- plug-ins that load, and go wrong later

// Two variables, one bent factor each; the second factor is the first that a search would not try
// first.
Graph Bent(const std::string& plugin, std::size_t factors = 2) {
  Graph graph(With({plugin}));
  for (std::size_t i = 0; i < factors; ++i) {
    graph.Add(Key("x", i), "vector1/1", {1});
    graph.Add({"bent/1", {Key("x", i)}, {3}, Noise::Unit(), {}, ""});
  }
  return graph;
}

SolveOptions Threads(int threads) {
  SolveOptions options;
  options.threads = threads;
  return options;
}

void ExpectFailureThatNames(const std::string& plugin, const std::string& reason) {
  const Graph graph = Bent(plugin);
  for (const int threads : {1, 2}) {
    const Report report = Solve(graph, Threads(threads)).report;
    EXPECT_EQ(report.termination, Termination::kFailed);
    EXPECT_NE(report.message.find("factor 0 bent/1 (x:0)"), std::string::npos) << report.message;
    EXPECT_NE(report.message.find(reason), std::string::npos) << report.message;
  }
}

TEST(HostileFactor, StraightenedIsSolved) {
  const Solution solution = Solve(Bent("straight"));
  EXPECT_EQ(solution.report.termination, Termination::kConverged);
  EXPECT_NEAR(solution.values.At(Key("x:1"))[0], 3, 1e-12);
}

TEST(HostileFactor, ThatThrowsWhereItIsMadeIsRefusedWithItsKeys) {
  Graph graph(With({"throws_in_create"}));
  graph.Add(Key("x:0"), "vector1/1", {1});
  try {
    graph.Add({"bent/1", {Key("x:0")}, {3}, Noise::Unit(), {}, ""});
    ADD_FAILURE();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("bent/1 (x:0)"), std::string::npos) << message;
    EXPECT_NE(message.find("out of cheese"), std::string::npos) << message;
  }
  EXPECT_EQ(graph.FactorCount(), 0u);
}

TEST(HostileFactor, ThatThrowsWhenSolveMakesItIsRefusedWithItsKeys) {
  const Graph graph = Bent("throws_in_third_create");
  try {
    Solve(graph);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("bent/1 (x:0)"), std::string::npos) << error.what();
  }
}

TEST(HostileFactor, ThatThrowsWhenEvaluatedFailsTheSolveAndNotTheProcess) {
  ExpectFailureThatNames("throws_in_evaluate", "out of cheese");
}

TEST(HostileFactor, ThatThrowsHasNoChi2) {
  const Graph graph = Bent("throws_in_evaluate");
  EXPECT_TRUE(std::isnan(FactorChi2(graph, graph.InitialValues())[1]));
}

TEST(HostileFactor, ThatReturnsNanFailsTheSolve) {
  ExpectFailureThatNames("nan_residual", "returned a residual that is not finite");
  ExpectFailureThatNames("nan_jacobian", "returned a Jacobian that is not finite");
}

TEST(HostileFactor, ThatReturnsNanHasNoMarginals) {
  const Graph graph = Bent("nan_jacobian");
  EXPECT_THROW(ComputeMarginals(graph, graph.InitialValues(), {Key("x:0")}), Error);
}

TEST(HostileFactor, WhoseMessageHasNoEndIsQuotedUpToItsRoom) {
  const Report report = Solve(Bent("long_error")).report;
  EXPECT_EQ(report.termination, Termination::kFailed);
  EXPECT_LT(report.message.size(), 600u);
}

TEST(HostileFactor, WithMoreResidualsThanItsSchemaIsRefused) {
  Graph graph(With({"wrong_residual_count"}));
  graph.Add(Key("x:0"), "vector1/1", {1});
  try {
    graph.Add({"bent/1", {Key("x:0")}, {3}, Noise::Unit(), {}, ""});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("1000"), std::string::npos) << error.what();
  }
}

TEST(HostileFactor, WithAWrongJacobianIsFoundByTheCheck) {
  Graph graph(With({"wrong_jacobian"}));
  graph.Add(Key("x:0"), "point2/1", {1, 2});
  graph.Add(Key("x:1"), "point2/1", {3, 5});
  graph.Add({"bent/1", {Key("x:0"), Key("x:1")}, {1, 1}, Noise::Unit(), {}, ""});
  const std::vector<JacobianCheck> checks = CheckJacobians(graph, graph.InitialValues());
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_EQ(checks[0].wrong, 1u);
  EXPECT_EQ(checks[0].worst_row, 1);
  EXPECT_EQ(checks[0].worst_block, "b");
  EXPECT_EQ(checks[0].worst_field, "y");
  EXPECT_EQ(checks[0].analytic, -1);
  EXPECT_NEAR(checks[0].numeric, 1, 1e-9);
}

TEST(HostileFactor, ThatThrowsIsCountedAsFailedByTheCheck) {
  const Graph graph = Bent("throws_in_evaluate");
  const std::vector<JacobianCheck> checks = CheckJacobians(graph, graph.InitialValues());
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_EQ(checks[0].failed, 2u);
  EXPECT_NE(checks[0].failure.find("out of cheese"), std::string::npos) << checks[0].failure;
}

}  // namespace
}  // namespace graticule
