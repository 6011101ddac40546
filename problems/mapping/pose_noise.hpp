#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/solver/noise.hpp"

namespace graticule {

/// Ad(T): T exp(xi) = exp(Ad(T) xi) T, for xi = [x y yaw].
inline Eigen::Matrix3d Adjoint(const PlanarPose& pose) {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  Eigen::Matrix3d adjoint;
  adjoint << c, -s, pose.y, s, c, -pose.x, 0, 0, 1;
  return adjoint;
}

/// The information of what has `information`, and besides errors of these standard deviations:
/// (information^-1 + floor)^-1, also where the information is singular.
inline Eigen::Matrix3d WithFloor(const Eigen::Matrix3d& information, double sigma_m,
                                 double sigma_rad) {
  Eigen::Matrix3d floor = Eigen::Matrix3d::Zero();
  floor.diagonal() << 1 / (sigma_m * sigma_m), 1 / (sigma_m * sigma_m), 1 / (sigma_rad * sigma_rad);
  const Eigen::Matrix3d sum = information + floor;
  Eigen::Matrix3d result = floor - floor * sum.inverse() * floor;
  return (result + result.transpose().eval()) / 2;
}

/// As a factor's noise.  Directions without any information get a little, to be definite.
inline Noise InformationNoise(Eigen::Matrix3d information) {
  information.diagonal() += Eigen::Vector3d(1e-2, 1e-2, 1e-2);
  return Noise::Information({information(0, 0), information(0, 1), information(0, 2),
                             information(1, 1), information(1, 2), information(2, 2)});
}

}  // namespace graticule
