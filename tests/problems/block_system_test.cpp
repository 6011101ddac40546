#include "graticule/problems/pose_graph/block_system.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <random>

#include "graticule/problems/pose_graph/nearest_rotation.hpp"

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

TEST(NearestRotation, AgreesWithSingularValues) {
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    Eigen::Matrix3d matrix = Random(3, 3, &random);
    if (i % 3 == 0) matrix.col(2) *= 1e-6;  // nearly singular
    if (i % 5 == 0) matrix *= 1e-9;         // far from the root relaxed rotations shrink
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double mirrors = svd.matrixU().determinant() * svd.matrixV().determinant();
    const Eigen::Matrix3d expected =
        svd.matrixU() * Eigen::Vector3d(1, 1, mirrors).asDiagonal() * svd.matrixV().transpose();
    Eigen::Quaterniond q;
    NearestRotation(matrix, q.coeffs().data());
    // The answer is as uncertain as rounding is large beside what tells it from its neighbours.
    const auto sizes = svd.singularValues();
    const double gap = (sizes[1] + mirrors * sizes[2]) / sizes[0];
    EXPECT_LT((q.toRotationMatrix() - expected).norm(), 1e-14 / std::min(1.0, gap) + 1e-13)
        << matrix;
  }
}

}  // namespace
}  // namespace graticule
