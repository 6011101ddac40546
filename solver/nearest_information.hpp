#pragma once

#include <optional>

#include "graticule/solver/span.hpp"

namespace graticule {

/// Eigenvalues of a projected information matrix are at least this share of its largest one in
/// magnitude: far above rounding, so that Cholesky's method succeeds, and small enough that what is
/// said along such a direction hardly counts.
inline constexpr double kInformationFloor = 1e-9;

/// What a projection did to an information matrix.
struct InformationProjection {
  double smallest_eigenvalue = 0;  ///< of the matrix as it was given
  double change = 0;               ///< |after - before| / |before| (Frobenius)
};

/// Makes an information matrix of `size` rows (its upper triangle, row by row) positive definite as
/// CheckNoise asks: the nearest one (Frobenius) with eigenvalues of at least kInformationFloor
/// times the largest magnitude of them.  Rows that are exactly zero were not measured, and stay
/// zero.
///
/// Empty, and nothing is changed, where there is nothing to repair (the matrix passes CheckNoise)
/// or nothing that could be (a number is not finite, or the repaired ones would not be).
std::optional<InformationProjection> ProjectInformation(Span<double> upper_triangle, int size);

}  // namespace graticule
