#include "graticule/io/camera_pose.hpp"

#include <cmath>

namespace graticule {
namespace {

void Rotate(const std::array<double, 9>& r, const double* v, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2];
}

void Normalise(CameraPose* pose) {
  double* q = pose->data() + 3;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  // The sign that files have: w is not negative.
  const double scale = std::copysign(1 / norm, q[3]);
  for (int i = 0; i < 4; ++i) q[i] *= scale;
}

}  // namespace

CameraPose Compose(const CameraPose& a, const CameraPose& b) {
  CameraPose c;
  Rotate(RotationMatrixOf(a), b.data(), c.data());
  for (std::size_t i = 0; i < 3; ++i) c[i] += a[i];
  const double *p = a.data() + 3, *q = b.data() + 3;
  c[3] = p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1];
  c[4] = p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0];
  c[5] = p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3];
  c[6] = p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2];
  Normalise(&c);
  return c;
}

CameraPose Inverse(const CameraPose& pose) {
  CameraPose inverse = {0, 0, 0, -pose[3], -pose[4], -pose[5], pose[6]};
  Rotate(RotationMatrixOf(inverse), pose.data(), inverse.data());
  for (std::size_t i = 0; i < 3; ++i) inverse[i] = 0 - inverse[i];
  Normalise(&inverse);
  return inverse;
}

std::array<double, 9> RotationMatrixOf(const CameraPose& pose) {
  const double x = pose[3], y = pose[4], z = pose[5], w = pose[6];
  const double s = 2 / (x * x + y * y + z * z + w * w);
  return {1 - s * (y * y + z * z), s * (x * y - z * w),     s * (x * z + y * w),
          s * (x * y + z * w),     1 - s * (x * x + z * z), s * (y * z - x * w),
          s * (x * z - y * w),     s * (y * z + x * w),     1 - s * (x * x + y * y)};
}

CameraPose PoseOf(const double* r, const double* t) {
  // The largest of these is far from zero.
  const double squares[4] = {1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8], 1 - r[0] - r[4] + r[8],
                             1 + r[0] + r[4] + r[8]};
  int largest = 3;
  for (int i = 0; i < 3; ++i)
    if (squares[i] > squares[largest]) largest = i;
  const double xy = r[1] + r[3], xz = r[2] + r[6], yz = r[5] + r[7];
  const double xw = r[7] - r[5], yw = r[2] - r[6], zw = r[3] - r[1];
  const double rows[4][4] = {{squares[0], xy, xz, xw},
                             {xy, squares[1], yz, yw},
                             {xz, yz, squares[2], zw},
                             {xw, yw, zw, squares[3]}};
  CameraPose pose = {t[0], t[1], t[2]};
  for (std::size_t i = 0; i < 4; ++i) pose[3 + i] = rows[largest][i];
  Normalise(&pose);
  return pose;
}

std::array<double, 6> RotationVectorOf(const CameraPose& pose) {
  const double x = pose[3], y = pose[4], z = pose[5];
  const double sine = std::sqrt(x * x + y * y + z * z);
  const double sign = pose[6] < 0 ? -1 : 1;
  const double scale = sine > 0 ? sign * 2 * std::atan2(sine, sign * pose[6]) / sine : 2;
  return {scale * x, scale * y, scale * z, pose[0], pose[1], pose[2]};
}

CameraPose PoseOfRotationVector(const double* rt) {
  const double angle = std::sqrt(rt[0] * rt[0] + rt[1] * rt[1] + rt[2] * rt[2]);
  const double scale = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  CameraPose pose = {
      rt[3], rt[4], rt[5], scale * rt[0], scale * rt[1], scale * rt[2], std::cos(angle / 2)};
  Normalise(&pose);
  return pose;
}

bool IsRotation(const double* r) {
  constexpr double kOff = 1e-6;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= i; ++k) {
      const double product =
          r[3 * i] * r[3 * k] + r[3 * i + 1] * r[3 * k + 1] + r[3 * i + 2] * r[3 * k + 2];
      if (!(std::abs(product - (i == k)) < kOff)) return false;
    }
  return r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
             r[2] * (r[3] * r[7] - r[4] * r[6]) >
         0;
}

}  // namespace graticule
