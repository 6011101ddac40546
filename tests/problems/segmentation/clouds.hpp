#pragma once

#include <cmath>
#include <vector>

#include "graticule/io/cloud.hpp"
#include "graticule/problems/random.hpp"

namespace graticule::test {

/// A depth camera's view of bumps, with missing returns and colours, all at random.
inline PointCloud RandomCloud(std::size_t width, std::size_t height, std::uint64_t seed) {
  RandomNumbers random(seed);
  PointCloud cloud;
  cloud.width = width;
  cloud.height = height;
  const double phase = random.Uniform(0, 6), step = random.Uniform(0.05, 0.4);
  const int shades = 1 + static_cast<int>(random.Below(60));
  for (std::size_t r = 0; r < height; ++r)
    for (std::size_t c = 0; c < width; ++c) {
      const double u = 0.01 * (static_cast<double>(c) - 0.5 * static_cast<double>(width));
      const double v = 0.01 * (static_cast<double>(r) - 0.5 * static_cast<double>(height));
      double z = 1 + 0.1 * std::sin(30 * u + phase) * std::cos(20 * v) + 0.002 * random.Normal();
      if (u > 0.1) z += step;
      if (random.Unit() < 0.05)
        cloud.in_sensor.push_back(kNoReturn);
      else
        cloud.in_sensor.push_back(Eigen::Vector3d(u * z, v * z, z).cast<float>());
      Rgb colour;
      for (std::uint8_t& channel : colour)
        channel = static_cast<std::uint8_t>(random.Below(static_cast<std::uint64_t>(shades)) * 4);
      cloud.colours.push_back(colour);
    }
  return cloud;
}

/// Whether two lists of names part a set alike, whatever the names.
inline bool IsSamePartition(const std::vector<std::uint32_t>& a,
                            const std::vector<std::uint32_t>& b) {
  if (a.size() != b.size()) return false;
  std::vector<std::int64_t> to(a.size() + 1, -1), from(a.size() + 1, -1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (to[a[i]] < 0 && from[b[i]] < 0) {
      to[a[i]] = b[i];
      from[b[i]] = a[i];
    }
    if (to[a[i]] != b[i] || from[b[i]] != a[i]) return false;
  }
  return true;
}

}  // namespace graticule::test
