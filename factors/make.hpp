#pragma once

#include <array>
#include <string>
#include <utility>

#include "graticule/solver/factor.hpp"

namespace graticule {

/// Factors from typed arguments, for programs that build graphs: `graph.Add(BetweenSe2Factor(...))`
/// cannot have its numbers in the wrong count.  Order and units as the factor's schema says; poses
/// are [x y yaw] and [x y z qx qy qz qw].

using Se2Array = std::array<double, 3>;
using Se3Array = std::array<double, 7>;

template <std::size_t kSize>
Factor MakeFactor(const char* type, std::vector<Key> keys,
                  const std::array<double, kSize>& measurement, Noise noise, std::string source) {
  return {type,   std::move(keys),  {measurement.begin(), measurement.end()}, std::move(noise),
          Loss{}, std::move(source)};
}

inline Factor PriorSe2Factor(Key pose, const Se2Array& world_from_body, Noise noise,
                             std::string source = "prior") {
  return MakeFactor("prior_se2/1", {pose}, world_from_body, std::move(noise), std::move(source));
}

inline Factor PriorSe3Factor(Key pose, const Se3Array& world_from_body, Noise noise,
                             std::string source = "prior") {
  return MakeFactor("prior_se3/1", {pose}, world_from_body, std::move(noise), std::move(source));
}

inline Factor BetweenSe2Factor(Key a, Key b, const Se2Array& a_from_b, Noise noise,
                               std::string source = "") {
  return MakeFactor("between_se2/1", {a, b}, a_from_b, std::move(noise), std::move(source));
}

/// Rotation noise is of the rotation vector [rad]: the full angle.
inline Factor BetweenSe3Factor(Key a, Key b, const Se3Array& a_from_b, Noise noise,
                               std::string source = "") {
  return MakeFactor("between_se3/1", {a, b}, a_from_b, std::move(noise), std::move(source));
}

inline Factor LandmarkSe2Factor(Key pose, Key landmark,
                                const std::array<double, 2>& landmark_in_body, Noise noise,
                                std::string source = "") {
  return MakeFactor("landmark_se2/1", {pose, landmark}, landmark_in_body, std::move(noise),
                    std::move(source));
}

inline Factor BearingRangeSe2Factor(Key pose, Key landmark, double bearing_rad, double range_m,
                                    Noise noise, std::string source = "") {
  return MakeFactor("bearing_range_se2/1", {pose, landmark},
                    std::array<double, 2>{bearing_rad, range_m}, std::move(noise),
                    std::move(source));
}

/// East, north, up of the antenna [m], and its place on the body [m, in the body's frame].
inline Factor PositionSe3Factor(Key pose, const std::array<double, 3>& antenna_in_world,
                                const std::array<double, 3>& lever_in_body, Noise noise,
                                std::string source = "gnss") {
  const std::array<double, 6> measurement = {antenna_in_world[0], antenna_in_world[1],
                                             antenna_in_world[2], lever_in_body[0],
                                             lever_in_body[1],    lever_in_body[2]};
  return MakeFactor("position_se3/1", {pose}, measurement, std::move(noise), std::move(source));
}

/// Latitude, longitude [degrees], height [m] of the antenna and of the world's datum, and the
/// antenna's place on the body [m, in the body's frame].
inline Factor GeodeticSe2Factor(Key pose, const std::array<double, 3>& antenna,
                                const std::array<double, 3>& datum,
                                const std::array<double, 2>& lever_in_body, Noise noise,
                                std::string source = "gnss") {
  const std::array<double, 8> measurement = {antenna[0],       antenna[1],      antenna[2],
                                             datum[0],         datum[1],        datum[2],
                                             lever_in_body[0], lever_in_body[1]};
  return MakeFactor("geodetic_se2/1", {pose}, measurement, std::move(noise), std::move(source));
}

inline Factor BalReprojectionFactor(Key camera, Key point, double u_px, double v_px, Noise noise,
                                    std::string source = "") {
  return MakeFactor("bal_reprojection/1", {camera, point}, std::array<double, 2>{u_px, v_px},
                    std::move(noise), std::move(source));
}

}  // namespace graticule
