#pragma once

// Internal to io/toro_*.cpp.

#include <algorithm>
#include <cmath>

namespace graticule {

/// The unit quaternion x y z w of Rz(yaw) Ry(pitch) Rx(roll).
inline void QuaternionFromAngles(const double* roll_pitch_yaw, double* q) {
  const double cr = std::cos(roll_pitch_yaw[0] / 2), sr = std::sin(roll_pitch_yaw[0] / 2);
  const double cp = std::cos(roll_pitch_yaw[1] / 2), sp = std::sin(roll_pitch_yaw[1] / 2);
  const double cy = std::cos(roll_pitch_yaw[2] / 2), sy = std::sin(roll_pitch_yaw[2] / 2);
  q[0] = sr * cp * cy - cr * sp * sy;
  q[1] = cr * sp * cy + sr * cp * sy;
  q[2] = cr * cp * sy - sr * sp * cy;
  q[3] = cr * cp * cy + sr * sp * sy;
}

/// The inverse; at pitch +-90 degrees, where roll and yaw turn about one axis, roll is 0.
inline void AnglesFromQuaternion(const double* q, double* roll_pitch_yaw) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  const double sine = 2 * (w * y - z * x);
  const double cosine_yaw = 1 - 2 * (y * y + z * z), sine_yaw = 2 * (x * y + w * z);
  // The pitch by atan2: asin loses half the digits near +-90 degrees.
  const double cosine = std::hypot(cosine_yaw, sine_yaw);
  roll_pitch_yaw[1] = std::atan2(sine, cosine);
  if (cosine > 1e-9) {
    roll_pitch_yaw[0] = std::atan2(2 * (y * z + w * x), 1 - 2 * (x * x + y * y));
    roll_pitch_yaw[2] = std::atan2(sine_yaw, cosine_yaw);
  } else {
    roll_pitch_yaw[0] = 0;
    roll_pitch_yaw[2] = std::atan2(2 * (w * z - x * y), 1 - 2 * (x * x + z * z));
  }
}

/// TORO writes a 3 x 3 information as I11 I12 I22 I33 I13 I23: where each entry of the upper
/// triangle, row by row, stands in a line.
inline constexpr int kToroOrder[6] = {0, 1, 4, 2, 5, 3};

}  // namespace graticule
