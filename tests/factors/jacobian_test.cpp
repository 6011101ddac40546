// Every built-in factor, found through the registry: a new one cannot be forgotten here.

#include <gtest/gtest.h>

#include <cmath>

#include "evaluate.hpp"

namespace graticule {
namespace {

using testing::Made;
using testing::Random;

constexpr std::uint64_t kSeed = 20240607;
constexpr int kStates = 60;

std::vector<std::string> FactorTypeNames() {
  std::vector<std::string> names;
  const Registry types = Builtins();
  for (const FactorType* type : types.FactorTypes()) names.push_back(type->name);
  return names;
}

std::string TestName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  for (char& c : name) c = c == '/' ? '_' : c;
  return name;
}

struct State {
  std::vector<double> measurement;
  std::vector<std::vector<double>> blocks;
};

State RandomState(const FactorType& type, Random* random) {
  State state;
  state.measurement = testing::RandomMeasurement(type.schema, random);
  for (const Block& block : type.schema.blocks)
    state.blocks.push_back(testing::RandomValue(Made::Variable(block.variable_type), random));
  if (type.name.find("reprojection_") != std::string::npos && state.blocks.size() == 4)
    testing::PlaceBeforeTheCamera(&state.blocks[1], &state.blocks[2], random);
  if (type.name.find("point_reprojection_") == 0) {
    std::vector<double> depth(7);
    testing::PlaceBeforeTheCamera(&state.blocks[1], &depth, random);
    state.blocks[1][2] = depth[2];
  }
  return state;
}

// The branch of a rotation error: vector part with w >= 0, rotation vector below pi, wrapped angle.
// The test of derivatives keeps away from it; known_values_test.cpp looks at it from near.
bool NearTheBranch(const FactorType& type, const std::vector<double>& residual) {
  double angle = 0, vector = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const Field& field = type.schema.residual[i];
    if (field.unit == "rad") angle += residual[i] * residual[i];
    if (field.name[0] == 'q') vector += residual[i] * residual[i];
  }
  return std::sqrt(angle) > 3.1 || std::sqrt(vector) > 0.9998;
}

// d(residual)/d(tangent) of one block, from what the factor wrote.
std::vector<double> TangentJacobian(const FactorType& type, const VariableType& variable,
                                    const std::vector<double>& x, const std::vector<double>& j,
                                    int rows) {
  if (type.HasTangentJacobians()) return j;
  const int n = variable.Size(), t = variable.TangentSize();
  std::vector<double> plus(static_cast<std::size_t>(n * t));
  variable.PlusJacobian(x.data(), plus.data());
  std::vector<double> product(static_cast<std::size_t>(rows * t));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < t; ++c)
      for (int k = 0; k < n; ++k)
        product[static_cast<std::size_t>(r * t + c)] +=
            j[static_cast<std::size_t>(r * n + k)] * plus[static_cast<std::size_t>(k * t + c)];
  return product;
}

class EveryFactor : public ::testing::TestWithParam<std::string> {
 protected:
  const FactorType type_ = *Builtins().FindFactorType(GetParam());
};

TEST_P(EveryFactor, HasTheJacobianOfItsResidual) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Random random(kSeed);
  for (int tried = 0; tried < kStates;) {
    const State state = RandomState(type_, &random);
    const Made factor(type_, state.measurement);
    std::vector<double> residual;
    std::vector<std::vector<double>> jacobians;
    ASSERT_TRUE(factor.Evaluate(state.blocks, &residual, &jacobians));
    if (NearTheBranch(type_, residual)) continue;
    ++tried;
    for (std::size_t b = 0; b < state.blocks.size(); ++b) {
      const VariableType variable = Made::Variable(type_.schema.blocks[b].variable_type);
      const std::vector<double> tangent =
          TangentJacobian(type_, variable, state.blocks[b], jacobians[b], factor.Size());
      const int columns = variable.TangentSize();
      for (int c = 0; c < columns; ++c) {
        // Five points: error h^4 f5/30 + 1e-16 f/h, with h = 1e-4.  Pixels (f = 1000) lose 1e-9 to
        // rounding.  A bearing has f5 = 24/d^5: 2e-8 from a landmark at 0.02 m, and the nearest of
        // these random ones is further off.
        const auto at = [&](double step) {
          std::vector<double> delta(static_cast<std::size_t>(columns));
          delta[static_cast<std::size_t>(c)] = step;
          auto moved = state.blocks;
          variable.Plus(state.blocks[b].data(), delta.data(), moved[b].data());
          return factor(moved);
        };
        const double h = 1e-4;
        const auto p1 = at(h), m1 = at(-h), p2 = at(2 * h), m2 = at(-2 * h);
        for (int r = 0; r < factor.Size(); ++r) {
          const auto row = static_cast<std::size_t>(r);
          const double numeric = (8 * (p1[row] - m1[row]) - (p2[row] - m2[row])) / (12 * h);
          const double analytic = tangent[static_cast<std::size_t>(r * columns + c)];
          ASSERT_TRUE(std::isfinite(analytic));
          ASSERT_NEAR(analytic, numeric, 1e-7 * std::max(1.0, std::abs(numeric)))
              << "block " << b << " row " << r << " column " << c;
        }
      }
    }
  }
}

TEST_P(EveryFactor, GivesTheSameResidualWithAndWithoutJacobians) {
  Random random(kSeed);
  const State state = RandomState(type_, &random);
  const Made factor(type_, state.measurement);
  std::vector<double> with, without;
  std::vector<std::vector<double>> jacobians;
  ASSERT_TRUE(factor.Evaluate(state.blocks, &with, &jacobians));
  ASSERT_TRUE(factor.Evaluate(state.blocks, &without));
  EXPECT_EQ(with, without);
  EXPECT_EQ(with.size(), type_.schema.residual.size());
}

TEST_P(EveryFactor, FillsOnlyTheJacobiansThatAreWanted) {
  Random random(kSeed);
  const State state = RandomState(type_, &random);
  const Made factor(type_, state.measurement);
  std::vector<double> residual;
  std::vector<std::vector<double>> all;
  ASSERT_TRUE(factor.Evaluate(state.blocks, &residual, &all));
  graticule_error error{};
  const graticule_measurement m = {sizeof(graticule_measurement),
                                   static_cast<std::int32_t>(state.measurement.size()),
                                   state.measurement.data()};
  std::int32_t rows = 0;
  void* made = type_.table->create(&m, static_cast<std::int32_t>(all.size()), &rows, &error);
  std::vector<const double*> x;
  for (const auto& block : state.blocks) x.push_back(block.data());
  for (std::size_t wanted = 0; wanted < all.size(); ++wanted) {
    std::vector<double> one(all[wanted].size(), std::nan(""));
    std::vector<double*> jacobians(all.size(), nullptr);
    jacobians[wanted] = one.data();
    EXPECT_TRUE(type_.table->evaluate(made, x.data(), residual.data(), jacobians.data(), &error));
    EXPECT_EQ(one, all[wanted]);
  }
  type_.table->destroy(made);
}

TEST_P(EveryFactor, DoesNotMindTheSignOfAQuaternion) {
  Random random(kSeed);
  for (int i = 0; i < kStates; ++i) {
    const State state = RandomState(type_, &random);
    const std::vector<double> expected = Made(type_, state.measurement)(state.blocks);
    State other = state;
    for (std::size_t f = 0; f < other.measurement.size(); ++f) {
      const std::string& name = type_.schema.measurement[f].name;
      if (name[0] == 'q' || name.substr(0, 2) == "sq") other.measurement[f] *= -1;
    }
    EXPECT_EQ(Made(type_, other.measurement)(state.blocks), expected);
    for (std::size_t b = 0; b < other.blocks.size(); ++b)
      if (type_.schema.blocks[b].variable_type == "se3/1")
        for (std::size_t f = 3; f < 7; ++f) other.blocks[b][f] *= -1;
    EXPECT_EQ(Made(type_, state.measurement)(other.blocks), expected);
  }
}

TEST_P(EveryFactor, IsBlindToTheWorldFrameExactlyWhereItSaysSo) {
  Random random(kSeed);
  const State state = RandomState(type_, &random);
  // Moved by 3, 4 (, 5) m and turned by 1 rad about the vertical.
  const double c = std::cos(1.0), s = std::sin(1.0);
  const double turn[4] = {0, 0, std::sin(0.5), std::cos(0.5)};
  State moved = state;
  for (std::size_t b = 0; b < state.blocks.size(); ++b) {
    const std::string& name = type_.schema.blocks[b].variable_type;
    if (name == "bal_camera/1") return;        // its world is on the other side
    if (name.rfind("vector", 0) == 0) return;  // numbers that are in no frame
    const std::vector<double>& x = state.blocks[b];
    std::vector<double>& y = moved.blocks[b];
    y[0] = 3 + c * x[0] - s * x[1];
    y[1] = 4 + s * x[0] + c * x[1];
    if (name == "se2/1") y[2] = x[2] + 1;
    if (name == "se3/1" || name == "point3/1") y[2] = x[2] + 5;
    if (name == "se3/1") QuaternionProduct(turn, x.data() + 3, y.data() + 3);
  }
  const auto before = Made(type_, state.measurement)(state.blocks);
  const auto after = Made(type_, state.measurement)(moved.blocks);
  double change = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    change = std::max(change, std::abs(before[i] - after[i]));
  if (type_.IsRelative()) {
    EXPECT_LT(change, 1e-13);
  } else {
    EXPECT_GT(change, 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Builtins, EveryFactor, ::testing::ValuesIn(FactorTypeNames()), TestName);

// ---------------------------------------------------------------------------------- variables

class EveryVariable : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryVariable, PlusUndoesMinusAndMinusUndoesPlus) {
  const VariableType type = Made::Variable(GetParam());
  Random random(kSeed);
  for (int i = 0; i < kStates; ++i) {
    const auto x = testing::RandomValue(type, &random), y = testing::RandomValue(type, &random);
    std::vector<double> delta(static_cast<std::size_t>(type.TangentSize())), back(x.size());
    type.Minus(y.data(), x.data(), delta.data());
    type.Plus(x.data(), delta.data(), back.data());
    std::vector<double> difference(delta.size());
    type.Minus(back.data(), y.data(), difference.data());
    // 1e-13 over values of order 1 (focal lengths of order 1000).
    for (const double d : difference) EXPECT_NEAR(d, 0, 1e-12);

    for (double& d : delta) d = testing::Uniform(&random, -1.5, 1.5);
    type.Plus(x.data(), delta.data(), back.data());
    type.Minus(back.data(), x.data(), difference.data());
    for (std::size_t f = 0; f < delta.size(); ++f) EXPECT_NEAR(difference[f], delta[f], 1e-12);
  }
}

TEST_P(EveryVariable, HasThePlusJacobianOfItsPlus) {
  const VariableType type = Made::Variable(GetParam());
  Random random(kSeed);
  const auto columns = static_cast<std::size_t>(type.TangentSize());
  for (int i = 0; i < kStates; ++i) {
    const auto x = testing::RandomValue(type, &random);
    std::vector<double> jacobian(x.size() * columns);
    type.PlusJacobian(x.data(), jacobian.data());
    for (std::size_t c = 0; c < columns; ++c) {
      std::vector<double> delta(columns), up(x.size()), down(x.size());
      const double h = 1e-5;  // h^2/6 and 1e-16 * 900/h
      delta[c] = h;
      type.Plus(x.data(), delta.data(), up.data());
      delta[c] = -h;
      type.Plus(x.data(), delta.data(), down.data());
      for (std::size_t r = 0; r < x.size(); ++r)
        EXPECT_NEAR(jacobian[r * columns + c], (up[r] - down[r]) / (2 * h), 2e-8);
    }
  }
}

std::vector<std::string> VariableTypeNames() {
  std::vector<std::string> names = {"vector1/1", "vector17/1"};
  const Registry types = Builtins();
  for (const VariableType* type : types.VariableTypes()) names.push_back(type->name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Builtins, EveryVariable, ::testing::ValuesIn(VariableTypeNames()),
                         TestName);

}  // namespace
}  // namespace graticule
