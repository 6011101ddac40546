// Plug-ins as they should be.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "graticule/factors/make.hpp"
#include "graticule/solver/check.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/solve.hpp"
#include "load.hpp"

namespace graticule {
namespace {

using testing::PluginFile;
using testing::With;

TEST(RadarPlugin, SaysWhatItIs) {
  Registry types = Builtins();
  const PluginInfo info = LoadPlugin(PluginFile("radar"), &types);
  EXPECT_EQ(info.file, PluginFile("radar"));
  EXPECT_EQ(info.name, "radar");
  EXPECT_EQ(info.version, "1.0.0");
  EXPECT_EQ(info.licence, "BSD-3-Clause");
  EXPECT_EQ(info.factor_types, (std::vector<std::string>{"radar_range/1", "radar_doppler/1"}));
  EXPECT_TRUE(info.variable_types.empty());
  const auto type = types.FindFactorType("radar_range/1");
  ASSERT_TRUE(type);
  EXPECT_TRUE(type->IsRelative());
  EXPECT_EQ(ToString(type->schema), "radar:se2/1 target:point2/1 | range:m");
}

// A radar at rest at three places, one target: exact measurements.
Graph Trilateration(const Registry& types, double x, double y) {
  Graph graph(types);
  const double places[3][3] = {{0, 0, 0}, {4, 0, 1}, {0, 4, 2}};
  graph.Add(Key("target:0"), "point2/1", {1, 1});
  for (unsigned i = 0; i < 3; ++i) {
    graph.Add(Key("radar", i), "se2/1", {places[i][0], places[i][1], places[i][2]}, true);
    graph.Add({"radar_range/1",
               {Key("radar", i), Key("target:0")},
               {std::hypot(x - places[i][0], y - places[i][1])},
               Noise::Sigma(0.1),
               {},
               "radar"});
  }
  return graph;
}

TEST(RadarPlugin, FindsItsTarget) {
  const Graph graph = Trilateration(With({"radar"}), 3, 2.5);
  const Solution solution = Solve(graph);
  EXPECT_EQ(solution.report.termination, Termination::kConverged);
  EXPECT_NEAR(solution.values.At(Key("target:0"))[0], 3, 1e-9);
  EXPECT_NEAR(solution.values.At(Key("target:0"))[1], 2.5, 1e-9);
}

TEST(RadarPlugin, HasRightJacobiansAndMarginals) {
  const Graph graph = Trilateration(With({"radar"}), 3, 2.5);
  const Solution solution = Solve(graph);
  for (const JacobianCheck& check : CheckJacobians(graph, solution.values))
    EXPECT_EQ(check.wrong + check.failed, 0u) << check.type << " " << check.worst;
  const auto marginals = ComputeMarginals(graph, solution.values, {Key("target:0")});
  ASSERT_TRUE(std::holds_alternative<Marginals>(marginals));
  // J has the unit vectors towards the target as rows: J'J = sum u u' / 0.01.
  double a = 0, b = 0, c = 0;
  for (const auto& [px, py] : {std::pair(0., 0.), std::pair(4., 0.), std::pair(0., 4.)}) {
    const double dx = 3 - px, dy = 2.5 - py, squared = dx * dx + dy * dy;
    a += dx * dx / squared / 0.01, b += dx * dy / squared / 0.01, c += dy * dy / squared / 0.01;
  }
  const auto& covariance = std::get<Marginals>(marginals).Covariance(Key("target:0"));
  EXPECT_NEAR(covariance[0], c / (a * c - b * b), 1e-12);
  EXPECT_NEAR(covariance[1], -b / (a * c - b * b), 1e-12);
  EXPECT_NEAR(covariance[3], a / (a * c - b * b), 1e-12);
}

TEST(RadarPlugin, RefusesARangeOfNothingInItsOwnWords) {
  Graph graph = Trilateration(With({"radar"}), 3, 2.5);
  try {
    graph.Add({"radar_range/1", {Key("radar:0"), Key("target:0")}, {0}, Noise::Unit(), {}, ""});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("expected a distance above 0 m"), std::string::npos);
  }
}

TEST(RadarPlugin, MeasuresItsOwnVelocityByDoppler) {
  Graph graph(With({"radar"}));
  const double velocity[2] = {2, -0.5}, yaw = 0.7;
  graph.Add(Key("radar:0"), "se2/1", {1, -1, yaw}, true);
  graph.Add(Key("velocity:0"), "vector2/1", {0, 0});
  const double targets[3][2] = {{5, 3}, {2, -6}, {-4, 1}};
  for (unsigned i = 0; i < 3; ++i) {
    graph.Add(Key("target", i), "point2/1", {targets[i][0], targets[i][1]}, true);
    const double dx = targets[i][0] - 1, dy = targets[i][1] + 1;
    const double vx = std::cos(yaw) * velocity[0] - std::sin(yaw) * velocity[1];
    const double vy = std::sin(yaw) * velocity[0] + std::cos(yaw) * velocity[1];
    graph.Add({"radar_doppler/1",
               {Key("radar:0"), Key("target", i), Key("velocity:0")},
               {-(vx * dx + vy * dy) / std::hypot(dx, dy)},
               Noise::Sigma(0.05),
               {},
               "radar"});
  }
  const Solution solution = Solve(graph);
  EXPECT_NEAR(solution.values.At(Key("velocity:0"))[0], 2, 1e-9);
  EXPECT_NEAR(solution.values.At(Key("velocity:0"))[1], -0.5, 1e-9);
  for (const JacobianCheck& check : CheckJacobians(graph, solution.values))
    EXPECT_EQ(check.wrong + check.failed, 0u) << check.type << " " << check.worst;
}

TEST(PluginVariable, IsMovedOnItsManifold) {
  Graph graph(With({"unit_vector"}));
  graph.Add(Key("up:0"), "unit_vector3/1", {0, 0, 1});
  // Three measurements around a direction: their mean, brought to unit length, is the answer.
  const double measured[3][3] = {{0.6, 0.1, 0.8}, {0.5, -0.1, 0.8}, {0.7, 0, 0.8}};
  for (const auto& m : measured)
    graph.Add({"direction/1", {Key("up:0")}, {m[0], m[1], m[2]}, Noise::Sigma(0.1), {}, "level"});
  for (const int threads : {1, 2}) {
    SolveOptions options;
    options.threads = threads;
    const Solution solution = Solve(graph, options);
    EXPECT_EQ(solution.report.termination, Termination::kConverged);
    EXPECT_EQ(solution.report.parameters, 2u);
    const auto up = solution.values.At(Key("up:0"));
    EXPECT_NEAR(up[0], 0.6, 1e-8);
    EXPECT_NEAR(up[1], 0, 1e-8);
    EXPECT_NEAR(up[2], 0.8, 1e-8);
    for (const JacobianCheck& check : CheckJacobians(graph, solution.values))
      EXPECT_EQ(check.wrong + check.failed, 0u) << check.worst << " at " << check.worst_field;
    const auto marginals = ComputeMarginals(graph, solution.values, {Key("up:0")});
    ASSERT_TRUE(std::holds_alternative<Marginals>(marginals));
    EXPECT_EQ(std::get<Marginals>(marginals).Covariance(Key("up:0")).size(), 4u);
  }
}

TEST(PluginVariable, RefusesWhatIsOffItsManifold) {
  Graph graph(With({"unit_vector"}));
  EXPECT_THROW(graph.Add(Key("up:0"), "unit_vector3/1", {0, 0, 2}), Error);
  EXPECT_EQ(graph.VariableCount(), 0u);
}

TEST(PluginVariable, MinusUndoesPlus) {
  const VariableType type = *With({"unit_vector"}).FindVariableType("unit_vector3/1");
  const double x[3] = {0.48, 0.6, 0.64}, delta[2] = {0.3, -1.1};
  double y[3], back[2];
  type.Plus(x, delta, y);
  type.Minus(y, x, back);
  EXPECT_NEAR(back[0], 0.3, 1e-14);
  EXPECT_NEAR(back[1], -1.1, 1e-14);
}

TEST(TwoPlugins, WithStructsOfTheSameNameKeepTheirOwn) {
  Graph graph(With({"same_name_1", "same_name_2"}));
  for (unsigned i = 1; i <= 2; ++i) {
    graph.Add(Key("x", i), "vector1/1", {0});
    graph.Add({"scaled_" + std::to_string(i) + "/1", {Key("x", i)}, {6}, Noise::Unit(), {}, ""});
  }
  const Solution solution = Solve(graph);
  EXPECT_NEAR(solution.values.At(Key("x:1"))[0], 6, 1e-12);
  EXPECT_NEAR(solution.values.At(Key("x:2"))[0], 3, 1e-12);
}

}  // namespace
}  // namespace graticule
