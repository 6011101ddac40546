// What the tests of factors/ do not see of variables: refusals, and what a plug-in may get wrong.

#include "graticule/solver/variable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "expect_error.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

graticule_variable_type_v1 Circle() {
  return {sizeof(graticule_variable_type_v1),
          0,
          "circle/1",
          "c s",
          "turn:rad",
          "direction in the plane",
          [](const double* x, const double* d, double* y) {
            y[0] = std::cos(*d) * x[0] - std::sin(*d) * x[1];
            y[1] = std::sin(*d) * x[0] + std::cos(*d) * x[1];
          },
          [](const double* x, double* j) {
            j[0] = -x[1];
            j[1] = x[0];
          },
          [](const double* y, const double* x, double* d) {
            *d = std::atan2(x[0] * y[1] - x[1] * y[0], x[0] * y[0] + x[1] * y[1]);
          },
          nullptr};
}

TEST(VariableType, ComesFromItsTable) {
  const graticule_variable_type_v1 table = Circle();
  const VariableType type = MakeVariableType(table, "here");
  EXPECT_EQ(type.Size(), 2);
  EXPECT_EQ(type.TangentSize(), 1);
  EXPECT_EQ(type.origin, "here");
  const double x[2] = {0.6, 0.8}, turn = 0.3;
  double y[2], back = 0;
  type.Plus(x, &turn, y);
  type.Minus(y, x, &back);
  EXPECT_NEAR(back, turn, 1e-15);
}

TEST(VariableType, IsRefusedWhereItsTableIsNotRight) {
  const auto refuse = [](const char* why, void (*bend)(graticule_variable_type_v1*)) {
    graticule_variable_type_v1 table = Circle();
    bend(&table);
    ExpectError(ErrorKind::kMissingType, {"here", why}, [&] { MakeVariableType(table, "here"); });
  };
  refuse("too short", [](auto* t) { t->size = 64; });
  refuse("name/version", [](auto* t) { t->name = "circle"; });
  refuse("name/version", [](auto* t) { t->name = nullptr; });
  refuse("no fields", [](auto* t) { t->fields = nullptr; });
  refuse("expected fields", [](auto* t) { t->fields = ""; });
  refuse("not all", [](auto* t) { t->minus = nullptr; });
  refuse("not all", [](auto* t) { t->plus = nullptr; });
  refuse("larger than its fields", [](auto* t) { t->tangent = "a b c"; });
  refuse("size of its fields", [](auto* t) {
    t->plus = nullptr;
    t->plus_jacobian = nullptr;
    t->minus = nullptr;
  });
}

// Against central differences of Minus, on both sides of the wrap and near it.
TEST(VariableType, KnowsHowItsDifferenceChanges) {
  const graticule_variable_type_v1 circle = Circle();
  std::vector<VariableType> types = {MakeVariableType(circle, "here")};
  for (const graticule_variable_type_v1* table : BuiltinVariableTables())
    types.push_back(MakeVariableType(*table, "built-in"));
  VariableType vector;
  ASSERT_TRUE(MakeVectorType("vector3/1", &vector));
  types.push_back(vector);
  std::mt19937_64 random(5);
  std::normal_distribution<double> gauss;
  for (const VariableType& type : types) {
    const auto size = static_cast<std::size_t>(type.Size());
    const auto n = static_cast<std::size_t>(type.TangentSize());
    // A quaternion, an angle and a direction are somewhere on their manifolds with (0 .. 0 1) or
    // (1 0) as the origin.
    std::vector<double> origin(size, 0.0);
    if (type.name == "so3/1" || type.name == "se3/1") origin.back() = 1;
    if (type.name == "circle/1") origin.front() = 1;
    for (const double scale : {0.0, 1e-4, 0.3, 1.5}) {
      std::vector<double> d(n), x(size), y(size), moved(size);
      for (double& v : d) v = gauss(random);
      type.Plus(origin.data(), d.data(), x.data());
      for (double& v : d) v = scale * gauss(random);
      type.Plus(x.data(), d.data(), y.data());
      std::vector<double> jacobian(n * n);
      type.MinusJacobian(y.data(), x.data(), jacobian.data());
      for (std::size_t c = 0; c < n; ++c) {
        std::vector<double> step(n, 0.0), there(n), back(n);
        step[c] = 1e-5;
        type.Plus(y.data(), step.data(), moved.data());
        type.Minus(moved.data(), x.data(), there.data());
        step[c] = -1e-5;
        type.Plus(y.data(), step.data(), moved.data());
        type.Minus(moved.data(), x.data(), back.data());
        for (std::size_t r = 0; r < n; ++r)
          EXPECT_NEAR(jacobian[r * n + c], (there[r] - back[r]) / 2e-5, 1e-8)
              << type.name << " " << scale << " " << r << " " << c;
      }
    }
  }
}

TEST(VariableType, ThatThrowsGivesNan) {
  graticule_variable_type_v1 table = Circle();
  table.plus = [](const double*, const double*, double*) { throw std::runtime_error("no"); };
  table.minus = [](const double*, const double*, double*) { throw 1; };
  table.plus_jacobian = [](const double*, double*) { throw 1; };
  table.normalise = [](double*) -> int32_t { throw 1; };
  const VariableType type = MakeVariableType(table, "here");
  double x[2] = {1, 0}, out[2] = {0, 0}, one = 0;
  type.Plus(x, &one, out);
  EXPECT_TRUE(std::isnan(out[0]) && std::isnan(out[1]));
  type.PlusJacobian(x, out);
  EXPECT_TRUE(std::isnan(out[0]) && std::isnan(out[1]));
  type.Minus(x, x, &one);
  EXPECT_TRUE(std::isnan(one));
  EXPECT_FALSE(type.Normalise(x));
}

}  // namespace
}  // namespace graticule
