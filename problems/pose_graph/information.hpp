#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/solver/factor.hpp"

namespace graticule {

/// A noise's information matrix.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> InformationOf(NoiseView noise) {
  Eigen::Matrix<double, kSize, kSize> information;
  information.setIdentity();
  if (noise.kind == NoiseKind::kSigma) {
    for (int i = 0; i < kSize; ++i) {
      const double sigma = noise.values[noise.values.size() == 1 ? 0 : static_cast<std::size_t>(i)];
      information(i, i) = 1 / (sigma * sigma);
    }
  } else if (noise.kind == NoiseKind::kInformation) {
    const double* value = noise.values.data();
    for (int i = 0; i < kSize; ++i)
      for (int j = i; j < kSize; ++j) information(i, j) = information(j, i) = *value++;
  }
  return information;
}

/// Trace of the inverse of a symmetric matrix; infinite where it is not positive definite.
template <class Matrix>
double TraceOfInverse(const Matrix& matrix) {
  constexpr int kSize = Matrix::RowsAtCompileTime;
  // Cholesky; the inverse's trace is the squared norm of the factor's inverse.
  double l[kSize][kSize] = {}, inverse[kSize][kSize] = {}, trace = 0;
  for (int j = 0; j < kSize; ++j) {
    double pivot = matrix(j, j);
    for (int k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
    if (!(pivot > 1e-14 * matrix(j, j))) return std::numeric_limits<double>::infinity();
    l[j][j] = std::sqrt(pivot);
    for (int i = j + 1; i < kSize; ++i) {
      double sum = matrix(i, j);
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = sum / l[j][j];
    }
  }
  for (int j = 0; j < kSize; ++j)
    for (int i = j; i < kSize; ++i) {
      double sum = i == j ? 1 : 0;
      for (int k = j; k < i; ++k) sum -= l[i][k] * inverse[k][j];
      inverse[i][j] = sum / l[i][i];
      trace += inverse[i][j] * inverse[i][j];
    }
  return trace;
}

/// Trace of a between factor's covariance, squared metres and squared radians alike; infinite where
/// a component was not measured.
inline double CovarianceTrace(const FactorView& factor, int residual_size) {
  if (residual_size == 3) return TraceOfInverse(InformationOf<3>(factor.noise));
  Eigen::Matrix<double, 6, 6> information = InformationOf<6>(factor.noise);
  if (IsHalfAngle(factor.type->name)) {  // of the whole angle
    information.rightCols<3>() /= 2;
    information.bottomRows<3>() /= 2;
  }
  return TraceOfInverse(information);
}

}  // namespace graticule
