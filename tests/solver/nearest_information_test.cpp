#include "graticule/solver/nearest_information.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "graticule/solver/noise.hpp"

namespace graticule {
namespace {

constexpr std::uint64_t kSeed = 5;

std::vector<double> UpperTriangle(const Eigen::MatrixXd& w) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < w.rows(); ++i)
    for (Eigen::Index j = i; j < w.cols(); ++j) values.push_back(w(i, j));
  return values;
}

Eigen::MatrixXd Whole(const std::vector<double>& upper, int n) {
  Eigen::MatrixXd w(n, n);
  std::size_t next = 0;
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) w(i, j) = w(j, i) = upper[next++];
  return w;
}

std::optional<InformationProjection> Project(std::vector<double>* upper, int n) {
  return ProjectInformation({upper->data(), upper->size()}, n);
}

TEST(ProjectInformation, KnowsTheAnswerOfTwoByTwo) {
  // Eigenvalues 3 along (1, 1), -1 along (1, -1): lifted to 3e-9.
  std::vector<double> upper = {1, 2, 1};
  const auto projection = Project(&upper, 2);
  ASSERT_TRUE(projection);
  EXPECT_NEAR(projection->smallest_eigenvalue, -1, 1e-15);
  EXPECT_NEAR(projection->change, (1 + 3e-9) / std::sqrt(10), 1e-15);
  EXPECT_NEAR(upper[0], 1.5 + 1.5e-9, 1e-15);
  EXPECT_NEAR(upper[1], 1.5 - 1.5e-9, 1e-15);
  EXPECT_NEAR(upper[2], 1.5 + 1.5e-9, 1e-15);
}

TEST(ProjectInformation, LiftsWhatIsSingularAndTurnsANegativeOneIntoNearlyNothing) {
  std::vector<double> singular = {1, 1, 1};
  const auto projection = Project(&singular, 2);
  ASSERT_TRUE(projection);
  EXPECT_NEAR(projection->smallest_eigenvalue, 0, 1e-15);
  EXPECT_NEAR(projection->change, kInformationFloor, 1e-15);
  std::vector<double> negative = {-4, 0, -2};
  ASSERT_TRUE(Project(&negative, 2));
  EXPECT_NEAR(negative[0], 4e-9, 1e-24);
  EXPECT_EQ(negative[1], 0);
  EXPECT_NEAR(negative[2], 4e-9, 1e-24);
}

TEST(ProjectInformation, LeavesAloneWhatIsGoodAndWhatIsNoNumber) {
  for (const std::vector<double>& upper :
       {std::vector<double>{2, 1, 0, 2, 0, 1},
        {4, 0, 0, 0, 0, 1},  // y was not measured
        {0, 0, 0, 0, 0, 0},
        {1, 2, std::nan(""), 1, 0, 1},
        {1, HUGE_VAL, 0, 1, 0, 1},
        // The nearest is no double: a half more than the largest.
        {1.7e308, 1.79e308, 0, 1.7e308, 1.79e308, 1.7e308}}) {
    std::vector<double> same = upper;
    EXPECT_FALSE(Project(&same, 3));
    for (std::size_t i = 0; i < upper.size(); ++i)
      EXPECT_TRUE(same[i] == upper[i] || std::isnan(upper[i]));
  }
}

TEST(ProjectInformation, KeepsWhatWasNotMeasured) {
  std::vector<double> upper = {1, 0, 2, 0, 0, 1};
  ASSERT_TRUE(Project(&upper, 3));
  EXPECT_NEAR(upper[0], 1.5, 1e-8);
  EXPECT_NEAR(upper[2], 1.5, 1e-8);
  for (const std::size_t of_y : {1, 3, 4}) EXPECT_EQ(upper[of_y], 0);
}

// What makes it the nearest: the change is positive semidefinite, and acts only along directions in
// which the result lies at the floor.
TEST(ProjectInformation, FindsTheNearestAndItIsAcceptedOfAnySizeAndScale) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> normal;
  for (int n = 1; n <= 9; ++n)
    for (const double scale : {1e-300, 1e-6, 1.0, 1e9, 1e300})
      for (int i = 0; i < 20; ++i) {
        Eigen::MatrixXd w = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
        w = scale * (w + w.transpose().eval());
        std::vector<double> upper = UpperTriangle(w);
        const auto projection = Project(&upper, n);
        if (!projection) {
          EXPECT_TRUE(IsDefiniteInformation(upper, n));
          continue;
        }
        EXPECT_NO_THROW(CheckNoise(Noise::Information(upper).View(), n));
        const Eigen::MatrixXd given = w / scale, nearest = Whole(upper, n) / scale;
        const Eigen::VectorXd eigenvalues =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(given).eigenvalues();
        const double largest = eigenvalues.cwiseAbs().maxCoeff();
        EXPECT_NEAR(projection->smallest_eigenvalue / scale, eigenvalues[0], 1e-13 * largest);
        const Eigen::MatrixXd change = nearest - given;
        EXPECT_NEAR(projection->change, change.norm() / given.norm(), 1e-13);
        EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(change).eigenvalues()[0],
                  -1e-13 * largest);
        const Eigen::MatrixXd floor = kInformationFloor * largest * Eigen::MatrixXd::Identity(n, n);
        EXPECT_LT((change * (nearest - floor)).norm(), 1e-13 * largest * largest);
        std::vector<double> again = upper;
        EXPECT_FALSE(Project(&again, n)) << "once is enough";
      }
}

}  // namespace
}  // namespace graticule
