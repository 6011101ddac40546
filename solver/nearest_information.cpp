#include "graticule/solver/nearest_information.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "graticule/solver/noise.hpp"

namespace graticule {

std::optional<InformationProjection> ProjectInformation(Span<double> upper_triangle, int size) {
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(upper_triangle.begin(), upper_triangle.end(), finite) ||
      IsDefiniteInformation({upper_triangle.data(), upper_triangle.size()}, size))
    return std::nullopt;
  Eigen::MatrixXd whole(size, size);
  const double* next = upper_triangle.data();
  for (int i = 0; i < size; ++i)
    for (int j = i; j < size; ++j) whole(i, j) = whole(j, i) = *next++;
  std::vector<int> measured;
  for (int i = 0; i < size; ++i)
    if (!whole.row(i).isZero(0)) measured.push_back(i);

  // Only as large as the numbers allow: squares of 1e200 are none.
  const double scale = whole.cwiseAbs().maxCoeff();
  const auto count = static_cast<Eigen::Index>(measured.size());
  Eigen::MatrixXd given(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      given(i, j) =
          whole(measured[static_cast<std::size_t>(i)], measured[static_cast<std::size_t>(j)]) /
          scale;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(given);
  if (eigen.info() != Eigen::Success) return std::nullopt;
  const double floor = kInformationFloor * eigen.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::MatrixXd nearest = eigen.eigenvectors() *
                                  eigen.eigenvalues().cwiseMax(floor).asDiagonal() *
                                  eigen.eigenvectors().transpose();

  std::vector<double> repaired(upper_triangle.begin(), upper_triangle.end());
  double difference = 0;
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = i; j < count; ++j) {
      const auto row = static_cast<std::size_t>(measured[static_cast<std::size_t>(i)]);
      const auto column = static_cast<std::size_t>(measured[static_cast<std::size_t>(j)]);
      const auto n = static_cast<std::size_t>(size);
      repaired[row * n - row * (row + 1) / 2 + column] = scale * nearest(i, j);
      const double by = nearest(i, j) - given(i, j);
      difference += (i == j ? 1 : 2) * by * by;
    }
  if (!std::all_of(repaired.begin(), repaired.end(), finite) ||
      !IsDefiniteInformation(repaired, size))
    return std::nullopt;
  std::copy(repaired.begin(), repaired.end(), upper_triangle.begin());
  InformationProjection projection;
  projection.smallest_eigenvalue = scale * eigen.eigenvalues()[0];
  projection.change = std::sqrt(difference) / given.norm();
  return projection;
}

}  // namespace graticule
