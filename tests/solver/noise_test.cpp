#include "graticule/solver/noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "expect_error.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

constexpr std::uint64_t kSeed = 11;

std::vector<double> UpperTriangle(const Eigen::MatrixXd& w) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < w.rows(); ++i)
    for (Eigen::Index j = i; j < w.cols(); ++j) values.push_back(w(i, j));
  return values;
}

Eigen::MatrixXd RandomInformation(int n, std::mt19937_64* random) {
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(*random); });
  return a.transpose() * a + 0.1 * Eigen::MatrixXd::Identity(n, n);
}

// |S r|^2 against r' W r, and S J against the same S, for whatever the whitener is.
void ExpectWhitens(const Noise& noise, const Eigen::MatrixXd& w, std::mt19937_64* random) {
  const int n = static_cast<int>(w.rows());
  ASSERT_NO_THROW(CheckNoise(noise.View(), n));
  const Whitener whitener(noise.View(), n);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd j = Eigen::MatrixXd::NullaryExpr(n, 3, [&] { return normal(*random); });
  // With a stride of 5: the two numbers beside each row are not to be touched.
  std::vector<double> matrix(static_cast<std::size_t>(n) * 5, 7.0);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < 3; ++c) matrix[static_cast<std::size_t>(r * 5 + c)] = j(r, c);
  whitener.Apply(matrix.data(), n, 3, 5);
  Eigen::MatrixXd sj(n, 3);
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < 3; ++c) sj(r, c) = matrix[static_cast<std::size_t>(r * 5 + c)];
    EXPECT_EQ(matrix[static_cast<std::size_t>(r * 5 + 3)], 7.0);
    EXPECT_EQ(matrix[static_cast<std::size_t>(r * 5 + 4)], 7.0);
  }
  const Eigen::MatrixXd expected = j.transpose() * w * j;
  EXPECT_LT((sj.transpose() * sj - expected).norm(), 1e-12 * (1 + expected.norm())) << n;
}

TEST(Whitener, ReproducesTheInformation) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  for (int n = 1; n <= 9; ++n)
    for (int i = 0; i < 20; ++i) {
      const Eigen::MatrixXd w = RandomInformation(n, &random);
      ExpectWhitens(Noise::Information(UpperTriangle(w)), w, &random);
    }
}

TEST(Whitener, ReproducesAnInformationWithComponentsThatWereNotMeasured) {
  std::mt19937_64 random(kSeed);
  for (int n = 2; n <= 7; ++n)
    for (int hidden = 0; hidden < n; ++hidden) {
      Eigen::MatrixXd w = RandomInformation(n, &random);
      w.row(hidden).setZero();
      w.col(hidden).setZero();
      ExpectWhitens(Noise::Information(UpperTriangle(w)), w, &random);
    }
  ExpectWhitens(Noise::Information({0, 0, 0, 0, 0, 0}), Eigen::MatrixXd::Zero(3, 3), &random);
}

TEST(Whitener, TakesADiagonalInformationUnitAndSigmas) {
  std::mt19937_64 random(kSeed);
  const Eigen::Vector3d diagonal(4, 0, 0.25);
  ExpectWhitens(Noise::Information({4, 0, 0, 0, 0, 0.25}), Eigen::MatrixXd(diagonal.asDiagonal()),
                &random);
  ExpectWhitens(Noise::Unit(), Eigen::MatrixXd::Identity(3, 3), &random);
  ExpectWhitens(Noise::Sigma(0.5), 4 * Eigen::MatrixXd::Identity(3, 3), &random);
  const Eigen::Vector3d information(1, 4, 0.25);
  ExpectWhitens(Noise::Sigmas({1, 0.5, 2}), Eigen::MatrixXd(information.asDiagonal()), &random);
}

TEST(Noise, ThatIsNotPositiveDefiniteIsRefused) {
  const auto refuse = [](std::vector<double> upper, int n) {
    ExpectError(ErrorKind::kInput, {"not positive definite"},
                [&] { CheckNoise(Noise::Information(upper).View(), n); });
  };
  refuse({-1}, 1);
  refuse({1, 2, 1}, 2);           // indefinite
  refuse({1, 1, 1}, 2);           // singular
  refuse({1, 0, 0, 0, 1, 0}, 3);  // the second is hidden, yet correlated with the third
  refuse({0, 1, 0, 1, 0, 1}, 3);  // a variance of zero with a covariance
  refuse({4, 2, 1 + 1e-16}, 2);   // singular to working precision
}

TEST(Noise, WithAWrongCountIsRefused) {
  ExpectError(ErrorKind::kInput, {"expected 1 or 3", "found 2"}, [] {
    CheckNoise(Noise::Sigmas({1, 2}).View(), 3);
  });
  ExpectError(ErrorKind::kInput, {"expected 6 numbers", "3 x 3", "found 9"},
              [] { CheckNoise(Noise::Information(std::vector<double>(9, 1)).View(), 3); });
  ExpectError(ErrorKind::kInput, {"unit noise takes no numbers"}, [] {
    CheckNoise(Noise{NoiseKind::kUnit, {1}}.View(), 3);
  });
  EXPECT_THROW(CheckNoise(Noise::Sigmas({}).View(), 3), Error);
}

TEST(Noise, ThatIsNotANumberOrNotAboveZeroIsRefused) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    ExpectError(ErrorKind::kInput, {"finite"}, [&] { CheckNoise(Noise::Sigma(bad).View(), 3); });
    ExpectError(ErrorKind::kInput, {"finite"},
                [&] { CheckNoise(Noise::Information({bad}).View(), 1); });
  }
  for (const double bad : {0.0, -1.0})
    ExpectError(ErrorKind::kInput, {"above zero"}, [&] {
      CheckNoise(Noise::Sigmas({1, bad, 1}).View(), 3);
    });
}

TEST(Noise, WhoseInverseOverflowsIsRefused) {
  // 1 / 1e-310 is not finite: every residual would be.
  EXPECT_THROW(CheckNoise(Noise::Sigma(1e-310).View(), 1), Error);
}

}  // namespace
}  // namespace graticule
