#include "graticule/solver/block_system.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace graticule {
namespace {

using Links = std::vector<std::pair<int, int>>;

Eigen::MatrixXd Random(int rows, int columns, std::mt19937* random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(*random); });
}

TEST(BlockSystem, AgreesWithADenseSolveForEveryRightHandSideAndEveryNumber) {
  std::mt19937 random(7);
  constexpr int kNodes = 9;
  // Parallel, in both directions, and node 8 by itself.
  const Links links = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6},
                       {6, 7}, {7, 0}, {2, 6}, {6, 2}, {2, 6}, {5, 1}};
  BlockSystem system(3, kNodes, links);
  const BlockSystem alike(3, kNodes, links, &system);
  for (int round = 0; round < 3; ++round) {
    system.Clear();
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * kNodes, 3 * kNodes);
    for (int node = 0; node < kNodes; ++node) {
      const Eigen::Matrix3d block = 40 * Eigen::Matrix3d::Identity();
      system.AddToNode(node, block);
      dense.block<3, 3>(3 * node, 3 * node) += block;
    }
    for (std::size_t i = 0; i < links.size(); ++i) {
      const Eigen::Matrix3d block = Random(3, 3, &random);
      system.AddToLink(i, block);
      dense.block<3, 3>(3 * links[i].first, 3 * links[i].second) += block;
      dense.block<3, 3>(3 * links[i].second, 3 * links[i].first) += block.transpose();
    }
    const Eigen::MatrixXd right = Random(3 * kNodes, 2, &random);
    std::vector<double> x(right.data(), right.data() + right.size());
    ASSERT_TRUE(system.Solve(&x, 2));
    const Eigen::MatrixXd expected = dense.lu().solve(right);
    const Eigen::Map<const Eigen::MatrixXd> found(x.data(), 3 * kNodes, 2);
    EXPECT_LT((found - expected).norm(), 1e-13 * expected.norm());
  }
}

TEST(BlockSystem, TakesNodesOfDifferentSizes) {
  std::mt19937 random(8);
  const std::vector<int> sizes = {3, 1, 6, 2, 3, 2};
  const Links links = {{0, 1}, {2, 1}, {2, 3}, {4, 3}, {0, 4}, {5, 2}, {1, 5}};
  BlockSystem system(sizes, links);
  ASSERT_EQ(system.Size(), 17);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(17, 17);
  const auto part = [&](int a, int b) {
    return dense.block(system.First(a), system.First(b), sizes[static_cast<std::size_t>(a)],
                       sizes[static_cast<std::size_t>(b)]);
  };
  for (int node = 0; node < 6; ++node) {
    const Eigen::MatrixXd half = Random(sizes[static_cast<std::size_t>(node)], 9, &random);
    const Eigen::MatrixXd block =
        half * half.transpose() + 40 * Eigen::MatrixXd::Identity(half.rows(), half.rows());
    system.AddToNode(node, block);
    part(node, node) += block;
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto [a, b] = links[i];
    const Eigen::MatrixXd block =
        Random(sizes[static_cast<std::size_t>(a)], sizes[static_cast<std::size_t>(b)], &random);
    system.AddToLink(i, block);
    part(a, b) += block;
    part(b, a) += block.transpose();
  }
  std::vector<double> diagonal;
  system.CopyDiagonal(&diagonal);
  for (int i = 0; i < 17; ++i) EXPECT_EQ(diagonal[static_cast<std::size_t>(i)], dense(i, i));

  const Eigen::VectorXd right = Random(17, 1, &random);
  std::vector<double> x(right.data(), right.data() + 17), product;
  system.Multiply(x, &product);
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(product.data(), 17) - dense * right).norm(), 1e-12);
  ASSERT_TRUE(system.Solve(&x, 1));
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), 17) - dense.lu().solve(right)).norm(), 1e-13);

  for (double& value : diagonal) value += 5;
  system.SetDiagonal(diagonal);
  std::vector<double> old(right.data(), right.data() + 17), damped = old;
  ASSERT_TRUE(system.SolveFactorised(old.data(), 1));
  EXPECT_EQ(old, x) << "by what was last factorised";
  ASSERT_TRUE(system.Solve(&damped, 1));
  const Eigen::VectorXd expected =
      (dense + 5 * Eigen::MatrixXd::Identity(17, 17)).lu().solve(right);
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(damped.data(), 17) - expected).norm(), 1e-13);
}

TEST(BlockSystem, RefusesWhatIsNotPositiveDefiniteAndLeavesTheRightHandSide) {
  BlockSystem system(2, 2, {{0, 1}});
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  system.AddToNode(0, one);
  system.AddToNode(1, one);
  system.AddToLink(0, Eigen::Matrix2d(2 * one));
  std::vector<double> x = {1, 2, 3, 4};
  EXPECT_FALSE(system.Solve(&x, 1));
  EXPECT_EQ(x, (std::vector<double>{1, 2, 3, 4}));
  system.Clear();
  EXPECT_FALSE(system.Solve(&x, 1));
  system.AddToNode(0, one);
  system.AddToNode(1, one);
  EXPECT_TRUE(system.Solve(&x, 1));
}

}  // namespace
}  // namespace graticule
