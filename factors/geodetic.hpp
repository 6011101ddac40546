#pragma once

#include <cmath>

#include "graticule/factors/lie.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

/// A place on the Earth (WGS 84: degrees, degrees, m above the ellipsoid) in metres to the east,
/// the north and up from a datum: rotated differences of Earth-centred coordinates, exactly.
inline Eigen::Vector3d EastNorthUp(const double* place, const double* datum) {
  constexpr double kRadius = 6378137, kFlattening = 1 / 298.257223563;
  constexpr double kE2 = kFlattening * (2 - kFlattening);
  const auto earth_centred = [](const double* p) {
    const double latitude = p[0] * M_PI / 180, longitude = p[1] * M_PI / 180;
    const double s = std::sin(latitude), c = std::cos(latitude);
    const double normal = kRadius / std::sqrt(1 - kE2 * s * s);
    return Eigen::Vector3d((normal + p[2]) * c * std::cos(longitude),
                           (normal + p[2]) * c * std::sin(longitude),
                           (normal * (1 - kE2) + p[2]) * s);
  };
  const double latitude = datum[0] * M_PI / 180, longitude = datum[1] * M_PI / 180;
  const double sp = std::sin(latitude), cp = std::cos(latitude);
  const double sl = std::sin(longitude), cl = std::cos(longitude);
  RowMajor<3, 3> local_from_earth;
  local_from_earth << -sl, cl, 0, -sp * cl, -sp * sl, cp, cp * cl, cp * sl, sp;
  return local_from_earth * (earth_centred(place) - earth_centred(datum));
}

/// A satellite receiver's antenna is at a measured place on the Earth.  The world's frame is the
/// datum's: x east, y north; the antenna sits on the body at the lever arm, given in its frame.
/// Residual [m, m] east, north: t + R lever - measured; zero when they agree.  The height counts
/// only in that it widens the metres of a degree.
struct GeodeticSe2 {
  static constexpr const char* kName = "geodetic_se2/1";
  static constexpr const char* kSchema =
      "pose:se2/1 | latitude:deg longitude:deg height:m datum_latitude:deg datum_longitude:deg "
      "datum_height:m lever_x:m lever_y:m | east:m north:m";
  static constexpr const char* kSummary =
      "GNSS antenna's place on the Earth is known, in a world east and north of a datum";
  static constexpr bool kTangentJacobians = true;

  Eigen::Vector2d antenna_in_world, lever_in_body;

  explicit GeodeticSe2(Measurement m)
      : antenna_in_world(EastNorthUp(m.values, m.values + 3).head<2>()),
        lever_in_body(m[6], m[7]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double* pose = blocks[0];
    Eigen::Matrix2d r;
    r << std::cos(pose[2]), -std::sin(pose[2]), std::sin(pose[2]), std::cos(pose[2]);
    Eigen::Map<Eigen::Vector2d>(residual, 2) =
        Eigen::Vector2d(pose[0], pose[1]) + r * lever_in_body - antenna_in_world;
    if (jacobians && jacobians[0]) {
      JacobianMap<2, 3> j(jacobians[0]);
      j.leftCols<2>() = r;
      j.col(2) = r * Eigen::Vector2d(-lever_in_body.y(), lever_in_body.x());
    }
    return true;
  }
};

}  // namespace graticule
