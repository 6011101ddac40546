// What the tests of factors/ do not see of variables: refusals, and what a plug-in may get wrong.

#include "graticule/solver/variable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

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
