// What the SDK does for a plug-in's author and no built-in factor needs: automatic derivatives, and
// exceptions that stop at the C table.

#include "graticule/factors/sdk.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "evaluate.hpp"

namespace graticule {
namespace {

using testing::Made;

struct AutomaticRange {
  static constexpr const char* kName = "automatic_range/1";
  static constexpr const char* kSchema = "pose:se2/1 landmark:point2/1 | range:m";
  static constexpr const char* kSummary = "range_se2/1 with automatic derivatives";
  double range_m;
  explicit AutomaticRange(Measurement m) : range_m(m[0]) {
    if (range_m < 0) throw std::invalid_argument("no such range");
  }
  template <class T>
  bool operator()(const T* pose, const T* landmark, T* residual) const {
    using std::sqrt;
    const T dx = landmark[0] - pose[0], dy = landmark[1] - pose[1];
    residual[0] = sqrt(dx * dx + dy * dy) - range_m;
    return true;
  }
};

struct Throwing {
  static constexpr const char* kName = "throwing/1";
  static constexpr const char* kSchema = "point:point2/1 | x:m";
  static constexpr const char* kSummary = "throws";
  explicit Throwing(Measurement) {}
  template <class T>
  bool operator()(const T*, T*) const {
    throw std::runtime_error("on a bad day");
  }
};

TEST(Sdk, DerivesAFunctorAutomatically) {
  const FactorType type = MakeFactorType(sdk::Table<AutomaticRange>::kTable, "test");
  const Made factor(type, {1});
  std::vector<double> residual;
  std::vector<std::vector<double>> jacobians;
  ASSERT_TRUE(factor.Evaluate({{1, 2, 0.5}, {4, 6}}, &residual, &jacobians));
  EXPECT_DOUBLE_EQ(residual[0], 4);
  const std::vector<double> by_pose = {-0.6, -0.8, 0}, by_landmark = {0.6, 0.8};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(jacobians[0][i], by_pose[i]);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_DOUBLE_EQ(jacobians[1][i], by_landmark[i]);
}

TEST(Sdk, StopsExceptionsAtTheTable) {
  const FactorType range = MakeFactorType(sdk::Table<AutomaticRange>::kTable, "test");
  EXPECT_THROW(Made(range, {-1}), std::runtime_error);
  const FactorType throwing = MakeFactorType(sdk::Table<Throwing>::kTable, "test");
  const double measured = 0, point[2] = {0, 0};
  const graticule_measurement m = {sizeof(graticule_measurement), 1, &measured};
  std::int32_t size = 0;
  graticule_error error{};
  void* factor = throwing.table->create(&m, 1, &size, &error);
  ASSERT_NE(factor, nullptr);
  EXPECT_EQ(size, 1);
  const double* blocks[1] = {point};
  double residual = 0;
  EXPECT_EQ(throwing.table->evaluate(factor, blocks, &residual, nullptr, &error), 0);
  EXPECT_STREQ(error.message, "on a bad day");
  throwing.table->destroy(factor);
}

}  // namespace
}  // namespace graticule
