#include "graticule/problems/pose_graph/nearest_rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <random>

namespace graticule {
namespace {

Eigen::MatrixXd Random(int rows, int columns, std::mt19937* random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(*random); });
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
