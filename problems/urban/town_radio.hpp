#pragma once

#include <cstdint>
#include <vector>

#include "graticule/io/signal_log.hpp"
#include "graticule/problems/attenuation/simulate_plan.hpp"
#include "graticule/problems/attenuation/simulate_radio.hpp"
#include "graticule/problems/mapping/simulate.hpp"

namespace graticule {

/// A town as radio waves find it: outer walls of concrete, walls between rooms of hollow blocks.
FloorPlan FloorPlanOf(const Town& town);

struct TownSignal {
  /// Radios robot1, ..., on the robots' centres, with their true positions in the town's frame.
  SignalLog log;
  std::vector<double> bias_db, sending_bias_db, listening_bias_db;  ///< of radios
  /// Links that were never measured, between where one robot was at one time and another at
  /// another, up to 30 m apart: what would be heard there on average, without fading.  Without
  /// times.
  SignalLog unmeasured;
};

/// What the robots of a mission hear of each other where they truly are; `rate_hz` packets of each
/// radio a second.  Between two scans robots drive evenly.  Same arguments, same digits.  Throws
/// Error (kUsage): fewer than two robots, a rate that is not above 0 and up to 1000 Hz.
TownSignal SimulateTownSignal(const SimulatedMission& mission, const RadioOptions& radio,
                              double rate_hz, std::uint64_t seed);

}  // namespace graticule
