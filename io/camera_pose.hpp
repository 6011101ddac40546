#pragma once

// Internal to the readers and writers of cameras: their places, as x y z qx qy qz qw.

#include <array>

namespace graticule {

using CameraPose = std::array<double, 7>;

constexpr CameraPose kCameraAtRig = {0, 0, 0, 0, 0, 0, 1};

/// a_from_b * b_from_c
CameraPose Compose(const CameraPose& a_from_b, const CameraPose& b_from_c);
CameraPose Inverse(const CameraPose& pose);

/// Row by row.
std::array<double, 9> RotationMatrixOf(const CameraPose& pose);
/// The nearest unit quaternion of a rotation matrix, row by row (Shepperd 1978).
CameraPose PoseOf(const double* rotation, const double* translation);

/// Axis times angle [rad], and the translation behind it: mrcal's rt.
std::array<double, 6> RotationVectorOf(const CameraPose& pose);
CameraPose PoseOfRotationVector(const double* rt);

/// Whether these are the rows of a rotation, to 1e-6: files have as few as eight digits.
bool IsRotation(const double* row_by_row);

}  // namespace graticule
