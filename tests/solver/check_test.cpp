#include "graticule/solver/check.hpp"

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "problems.hpp"

namespace graticule {
namespace {

using testing::Se2Loop;
using testing::TestTypes;

/// As between_se2/1 without the rotation of the frame, and with one wrong derivative: the yaw of b.
struct WrongFactor {
  static constexpr const char* kName = "wrong/1";
  static constexpr const char* kSchema = "from:se2/1 to:se2/1 | x:m y:m yaw:rad";
  static constexpr const char* kSummary = "has a wrong derivative";
  explicit WrongFactor(Measurement) {}
  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    for (int i = 0; i < 3; ++i) residual[i] = blocks[1][i] - blocks[0][i];
    for (int b = 0; jacobians && b < 2; ++b)
      for (int i = 0; jacobians[b] && i < 9; ++i)
        jacobians[b][i] = i % 4 ? 0 : b ? (i == 8 ? 1.01 : 1) : -1;
    return true;
  }
};

TEST(CheckJacobians, FindsNothingWrongWithWhatIsRight) {
  for (const Graph& graph : {Se2Loop(10, 0.05, 0.1), testing::Se3Loop(10, 0.02, 0.05)}) {
    const auto checks = CheckJacobians(graph, graph.InitialValues());
    ASSERT_EQ(checks.size(), 1u);
    EXPECT_EQ(checks[0].checked, 10u);
    EXPECT_EQ(checks[0].wrong, 0u) << checks[0].worst;
    EXPECT_EQ(checks[0].failed, 0u);
    EXPECT_LT(checks[0].worst, 1e-8);
  }
}

TEST(CheckJacobians, SaysWhichFactorRowBlockAndField) {
  Registry types = TestTypes();
  types.Add(MakeFactorType(sdk::Table<WrongFactor>::kTable, "test"));
  Graph graph(types);
  for (unsigned i = 0; i < 3; ++i) graph.Add(Key("pose", i), "se2/1", {1.0 * i, 2, 0.3});
  graph.Add(BetweenSe2Factor(Key("pose:0"), Key("pose:1"), {1, 0, 0}, Noise::Unit()));
  graph.Add({"wrong/1", {Key("pose:1"), Key("pose:2")}, {0, 0, 0}, Noise::Sigma(1e-3), {}, ""});
  const auto checks = CheckJacobians(graph, graph.InitialValues());
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].wrong, 0u);
  EXPECT_EQ(checks[1].type, "wrong/1");
  EXPECT_EQ(checks[1].wrong, 1u);
  EXPECT_EQ(checks[1].worst_factor, 1u);
  EXPECT_EQ(checks[1].worst_row, 2);
  EXPECT_EQ(checks[1].worst_block, "to");
  EXPECT_EQ(checks[1].worst_field, "yaw");
  EXPECT_NEAR(checks[1].analytic, 1.01, 1e-12);
  EXPECT_NEAR(checks[1].numeric, 1, 1e-9);
  EXPECT_EQ(CheckJacobians(graph, graph.InitialValues(), 0.1)[1].wrong, 0u) << "within tolerance";
}

TEST(CheckJacobians, GivesEachTypeItsOwnFailure) {
  Graph graph(TestTypes());
  graph.Add(Key("x:0"), "vector1/1", {-5});
  graph.Add({"limited/1", {Key("x:0")}, {1, 0}, Noise::Unit(), {}, ""});
  graph.Add({"log/1", {Key("x:0")}, {1}, Noise::Unit(), {}, ""});
  const auto checks = CheckJacobians(graph, graph.InitialValues());
  ASSERT_EQ(checks.size(), 2u);
  for (const JacobianCheck& check : checks) {
    EXPECT_EQ(check.failed, 1u);
    EXPECT_NE(check.failure.find(check.type), std::string::npos) << check.failure;
  }
}

TEST(CheckJacobians, RefusesValuesOfAnotherGraph) {
  const Graph graph = Se2Loop(6, 0.05, 0.1);
  testing::ExpectError(ErrorKind::kUsage, {"values"},
                       [&] { CheckJacobians(graph, Se2Loop(5, 0, 0).InitialValues()); });
}

}  // namespace
}  // namespace graticule
