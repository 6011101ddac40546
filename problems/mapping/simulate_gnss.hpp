#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/io/gnss.hpp"
#include "graticule/problems/mapping/simulate.hpp"

namespace graticule {

/// What a receiver on each robot's centre would have said during a mission: a fix every `every_s`,
/// normal with `sigma_m`, and `bad` of them, spread over all, 50 m off.  The town's frame is that
/// of the datum, x east.  Same seed, same digits.
std::vector<GnssFix> SimulateGnss(const SimulatedMission& simulated, const Geodetic& datum,
                                  double every_s, double sigma_m, std::size_t bad,
                                  std::uint64_t seed);

}  // namespace graticule
