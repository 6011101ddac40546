#include "graticule/solver/loss.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_error.hpp"

namespace graticule {
namespace {

std::vector<Loss> AllLosses() {
  std::vector<Loss> losses;
  for (const std::string_view name : LossNames())
    for (const double scale : {0.1, 1.0, 1.345, 30.0}) losses.push_back(MakeLoss(name, scale));
  return losses;
}

double Rho(const Loss& loss, double s, int derivative) {
  double rho[3];
  EvaluateLoss(loss, s, rho);
  return rho[derivative];
}

TEST(Loss, BeginsAsTheParabola) {
  for (const Loss& loss : AllLosses()) {
    EXPECT_EQ(Rho(loss, 0, 0), 0) << LossName(loss.kind);
    EXPECT_NEAR(Rho(loss, 0, 1), 1, 1e-15) << LossName(loss.kind);
  }
}

TEST(Loss, HasTheDerivativesThatItSays) {
  for (const Loss& loss : AllLosses())
    for (const double ratio : {0.01, 0.3, 0.9, 1.1, 2.0, 10.0}) {
      const double s = ratio * loss.scale * loss.scale, h = 1e-5 * s;
      SCOPED_TRACE(std::string(LossName(loss.kind)) + " scale " + std::to_string(loss.scale) +
                   " at s " + std::to_string(s));
      // Truncation (h/s)^2 and rounding 1e-16 s / h: both near 1e-10 of the first derivative.
      EXPECT_NEAR((Rho(loss, s + h, 0) - Rho(loss, s - h, 0)) / (2 * h), Rho(loss, s, 1), 1e-8);
      EXPECT_NEAR((Rho(loss, s + h, 1) - Rho(loss, s - h, 1)) / (2 * h), Rho(loss, s, 2),
                  1e-16 / h + 1e-7 * (1 + std::abs(Rho(loss, s, 2))));
    }
}

TEST(Loss, HasNoStepAtItsScaleAndNeverFallsOrExceedsTheParabola) {
  for (const Loss& loss : AllLosses()) {
    const double edge = loss.scale * loss.scale;
    for (const int derivative : {0, 1})
      EXPECT_NEAR(Rho(loss, edge * (1 - 1e-12), derivative),
                  Rho(loss, edge * (1 + 1e-12), derivative), 1e-10 * (1 + edge))
          << LossName(loss.kind);
    double last = 0;
    for (double s = 0; s < 20 * edge; s += edge / 16) {
      EXPECT_GE(Rho(loss, s, 0), last) << LossName(loss.kind);
      EXPECT_LE(Rho(loss, s, 0), s * (1 + 1e-12)) << LossName(loss.kind);
      EXPECT_GE(Rho(loss, s, 1), 0);
      last = Rho(loss, s, 0);
    }
  }
}

TEST(Loss, StaysFiniteFarOut) {
  for (const Loss& loss : AllLosses())
    for (const double s : {1e30, 1e150})
      for (const int derivative : {0, 1, 2})
        EXPECT_TRUE(std::isfinite(Rho(loss, s, derivative))) << LossName(loss.kind) << " " << s;
}

TEST(Loss, HasKnownValues) {
  EXPECT_DOUBLE_EQ(Rho(MakeLoss("huber", 1), 9, 0), 2 * 3 - 1);
  EXPECT_DOUBLE_EQ(Rho(MakeLoss("cauchy", 2), 4, 0), 4 * std::log(2));
  EXPECT_DOUBLE_EQ(Rho(MakeLoss("tukey", 3), 100, 0), 3);
  EXPECT_DOUBLE_EQ(Rho(MakeLoss("geman_mcclure", 2), 4, 0), 2);
  EXPECT_DOUBLE_EQ(Rho(MakeLoss("soft_l1", 1), 3, 0), 2);
  EXPECT_DOUBLE_EQ(Rho(MakeLoss("arctan", 1), 1, 0), M_PI / 4);
  EXPECT_DOUBLE_EQ(Rho(MakeLoss("none", 1), 5, 0), 5);
}

TEST(Loss, IsMadeByItsName) {
  for (const std::string_view name : LossNames()) {
    const Loss loss = MakeLoss(name, 2.5);
    EXPECT_EQ(LossName(loss.kind), name);
    EXPECT_EQ(loss.scale, 2.5);
  }
  testing::ExpectError(ErrorKind::kInput, {"hubert", "did you mean 'huber'?"},
                       [] { MakeLoss("hubert", 1); });
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL})
    testing::ExpectError(ErrorKind::kInput, {"scale above zero"},
                         [&] { MakeLoss("huber", scale); });
}

}  // namespace
}  // namespace graticule
