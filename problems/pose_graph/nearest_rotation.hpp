#pragma once

#include <Eigen/Core>

namespace graticule {

/// The unit quaternion (x y z w) of the rotation nearest to a 3 x 3 matrix (Frobenius), by Newton's
/// iteration for the polar factor; by singular values where the matrix mirrors or is nearly
/// singular.
void NearestRotation(const Eigen::Matrix3d& matrix, double* quaternion);

}  // namespace graticule
