#include "graticule/solver/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <random>
#include <set>

namespace graticule {
namespace {

// A random pattern of block columns, and numbers that make it positive definite.
struct Matrix {
  int size, nodes;
  std::vector<int> begins = {0}, rows;
  std::vector<double> values;
  Eigen::MatrixXd dense;

  Matrix(int block_size, int count, double density, unsigned seed)
      : size(block_size), nodes(count) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    dense = Eigen::MatrixXd::Zero(size * nodes, size * nodes);
    for (int j = 0; j < nodes; ++j) {
      for (int i = j; i < nodes; ++i) {
        if (i > j + 1 && uniform(random) > density) continue;
        rows.push_back(i);
        Eigen::MatrixXd block =
            Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(random); });
        if (i == j)
          block = Eigen::MatrixXd(block * block.transpose()) +
                  (20 + 4 * size * nodes * density) * Eigen::MatrixXd::Identity(size, size);
        dense.block(size * i, size * j, size, size) = block;
        dense.block(size * j, size * i, size, size) = block.transpose();
      }
      begins.push_back(static_cast<int>(rows.size()));
    }
    for (int j = 0; j < nodes; ++j)
      for (int c = 0; c < size; ++c)
        for (int k = begins[static_cast<std::size_t>(j)];
             k < begins[static_cast<std::size_t>(j) + 1]; ++k) {
          const int row = rows[static_cast<std::size_t>(k)];
          for (int r = 0; r < size; ++r) {
            // What lies above the diagonal is not to be read.
            const bool above = row == j && r < c;
            values.push_back(above ? std::numeric_limits<double>::quiet_NaN()
                                   : dense(size * row + r, size * j + c));
          }
        }
  }
  // Where the number on the diagonal of the last node stands.
  double& LastPivot() { return values.back(); }
};

class BlockCholeskyOfSize : public testing::TestWithParam<int> {};

TEST_P(BlockCholeskyOfSize, AgreesWithADenseFactorisation) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Matrix matrix(GetParam(), 1 + 2 * static_cast<int>(seed), 0.05, seed);
    const auto cholesky = BlockCholesky::Analyse(matrix.size, matrix.begins, matrix.rows);
    ASSERT_TRUE(cholesky);
    ASSERT_TRUE(cholesky->Factorise(matrix.values.data()));
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.size * matrix.nodes, -1, 2);
    const Eigen::VectorXd expected = matrix.dense.llt().solve(right);
    // Again and again, with what the solve before left behind.
    for (int again = 0; again < 2; ++again) {
      Eigen::VectorXd found = right;
      cholesky->Solve(found.data());
      EXPECT_LT((found - expected).norm(), 1e-13 * expected.norm());
    }
  }
}

TEST_P(BlockCholeskyOfSize, RefusesWhatIsNotPositiveDefinite) {
  Matrix matrix(GetParam(), 12, 0.2, 1);
  const auto cholesky = BlockCholesky::Analyse(matrix.size, matrix.begins, matrix.rows);
  ASSERT_TRUE(cholesky);
  const double good = matrix.LastPivot();
  for (const double bad : {0.0, -good, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    matrix.LastPivot() = bad;
    EXPECT_FALSE(cholesky->Factorise(matrix.values.data())) << bad;
  }
  matrix.LastPivot() = good;
  EXPECT_TRUE(cholesky->Factorise(matrix.values.data()));
}

INSTANTIATE_TEST_SUITE_P(Sizes, BlockCholeskyOfSize, testing::Values(2, 3, 6));

TEST(BlockCholesky, LeavesOthersToCholmod) {
  const Matrix of_four(4, 5, 0.2, 1);
  EXPECT_FALSE(BlockCholesky::Analyse(4, of_four.begins, of_four.rows));
  const Matrix full(6, 40, 1, 1);
  EXPECT_FALSE(BlockCholesky::Analyse(6, full.begins, full.rows));
}

}  // namespace
}  // namespace graticule
