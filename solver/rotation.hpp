#pragma once

#include <cmath>

namespace graticule {

/// Unit quaternions as four doubles x y z w, and rotation vectors (angle times axis): the storage
/// of so3/1 and se3/1.  Templates, so that factors may use them with automatic derivatives. Outputs
/// may not overlap inputs.

/// The angle in (-pi, pi].
inline double WrapAngle(double angle_rad) {
  if (angle_rad > -M_PI && angle_rad <= M_PI) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2 * M_PI);
  return wrapped > -M_PI ? wrapped : M_PI;
}

/// Brings a quaternion x y z w to unit length.  Text files carry six digits a number, so a squared
/// norm within 2e-3 of 1 is rounding; false, and q untouched, where it is further off.  A second
/// pass leaves the digits as they are.
inline bool NormaliseQuaternion(double* q) {
  const double squared_norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(std::abs(squared_norm - 1) < 2e-3)) return false;
  if (std::abs(squared_norm - 1) > 1e-15)
    for (int i = 0; i < 4; ++i) q[i] /= std::sqrt(squared_norm);
  return true;
}

/// p = a * b.
template <class T>
void QuaternionProduct(const T* a, const T* b, T* p) {
  p[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  p[1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
  p[2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
  p[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

/// p = inverse(a) * b.
template <class T>
void QuaternionInverseProduct(const T* a, const T* b, T* p) {
  const T inverse[4] = {-a[0], -a[1], -a[2], a[3]};
  QuaternionProduct(inverse, b, p);
}

/// v_rotated = R(q) v.
template <class T, class U>
void QuaternionRotate(const T* q, const U* v, T* v_rotated) {
  // v + 2 w (u x v) + 2 u x (u x v), with u the vector part
  const T c0 = q[1] * v[2] - q[2] * v[1];
  const T c1 = q[2] * v[0] - q[0] * v[2];
  const T c2 = q[0] * v[1] - q[1] * v[0];
  v_rotated[0] = v[0] + 2.0 * (q[3] * c0 + q[1] * c2 - q[2] * c1);
  v_rotated[1] = v[1] + 2.0 * (q[3] * c1 + q[2] * c0 - q[0] * c2);
  v_rotated[2] = v[2] + 2.0 * (q[3] * c2 + q[0] * c1 - q[1] * c0);
}

/// R(q), row-major.
inline void QuaternionToMatrix(const double* q, double* r) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  r[0] = 1 - 2 * (y * y + z * z);
  r[1] = 2 * (x * y - w * z);
  r[2] = 2 * (x * z + w * y);
  r[3] = 2 * (x * y + w * z);
  r[4] = 1 - 2 * (x * x + z * z);
  r[5] = 2 * (y * z - w * x);
  r[6] = 2 * (x * z - w * y);
  r[7] = 2 * (y * z + w * x);
  r[8] = 1 - 2 * (x * x + y * y);
}

/// Rotation vector of q, of length at most pi; q and -q give the same.
template <class T>
void QuaternionLog(const T* q, T* rotation) {
  using std::atan2;
  using std::sqrt;
  const T squared_sine = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
  T factor = T(2.0);
  if (squared_sine > T(1e-20)) {
    const T sine = sqrt(squared_sine);
    // The half angle in (-pi/2, pi/2]: the shorter way round.
    const T half = q[3] < T(0.0) ? atan2(-sine, -q[3]) : atan2(sine, q[3]);
    factor = 2.0 * half / sine;
  } else if (q[3] < T(0.0)) {
    factor = T(-2.0);
  }
  for (int i = 0; i < 3; ++i) rotation[i] = factor * q[i];
}

/// q = Exp(rotation), w >= 0 for angles up to pi.
inline void QuaternionExp(const double* rotation, double* q) {
  const double squared =
      rotation[0] * rotation[0] + rotation[1] * rotation[1] + rotation[2] * rotation[2];
  const double angle = std::sqrt(squared);
  // sin(angle/2)/angle, by its series where the quotient loses digits
  const double factor = squared > 1e-12 ? std::sin(angle / 2) / angle : 0.5 - squared / 48;
  for (int i = 0; i < 3; ++i) q[i] = factor * rotation[i];
  q[3] = std::cos(angle / 2);
}

/// y = q * Exp(rotation), of unit length.
inline void QuaternionPlus(const double* q, const double* rotation, double* y) {
  double change[4];
  QuaternionExp(rotation, change);
  QuaternionProduct(q, change, y);
  const double norm = std::sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3]);
  for (int i = 0; i < 4; ++i) y[i] /= norm;
}

}  // namespace graticule
