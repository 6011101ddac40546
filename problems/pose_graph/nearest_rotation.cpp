#include "graticule/problems/pose_graph/nearest_rotation.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace graticule {
namespace {

Eigen::Matrix3d BySingularValues(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1,
                        (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

void NearestRotation(const Eigen::Matrix3d& matrix, double* quaternion) {
  Eigen::Matrix3d rotation = matrix;
  double determinant = rotation.determinant();
  const double norm = rotation.norm();
  // A rotation's determinant is 0.19 of its norm's cube; far below, Newton's first steps are wild.
  if (!(determinant > 1e-4 * norm * norm * norm)) {
    rotation = BySingularValues(matrix);
  } else {
    // X <- (s X + (s X)^-T) / 2 with s = det(X)^(-1/3) (Higham 1986): quadratic, 9 at the most.
    for (int step = 0; step < 20; ++step) {
      const double scale = 1 / std::cbrt(determinant);
      Eigen::Matrix3d cofactors;  // det(X) X^-T
      cofactors.col(0) = rotation.col(1).cross(rotation.col(2));
      cofactors.col(1) = rotation.col(2).cross(rotation.col(0));
      cofactors.col(2) = rotation.col(0).cross(rotation.col(1));
      const Eigen::Matrix3d next = 0.5 * (scale * rotation + cofactors / (scale * determinant));
      const double change = (next - rotation).squaredNorm();
      rotation = next;
      if (change < 1e-20) break;  // squared: what is left is below 1e-16
      determinant = rotation.determinant();
    }
  }
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  for (int i = 0; i < 4; ++i) quaternion[i] = q.coeffs()[i];
}

}  // namespace graticule
