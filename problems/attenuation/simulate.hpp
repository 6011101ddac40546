#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/io/signal_log.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/attenuation/simulate_plan.hpp"
#include "graticule/problems/attenuation/simulate_radio.hpp"

namespace graticule {

/// Robots that explore a place and measure each other's signal.
struct SignalMissionOptions {
  PlaceOptions place;
  RadioOptions radio;
  int robots = 3;
  double rate_hz = 20;  ///< packets of each radio, which all others listen for
  double speed_m_s = 0.7;
  double height_m = 0;      ///< of the antennas
  double scan_every_s = 1;  ///< by a laser all around
  double scan_range_m = 20;
  double map_every_s = 30;  ///< a snapshot of the map; 0: only the last one
  std::uint64_t seed = 1;   ///< of ways, radios and fading; the place has its own

  /// Throws Error (kUsage): fewer than two robots, a rate that is not above zero, ...
  void Check() const;
};

/// The map as robots knew it from a time on.
struct TimedMap {
  double time_s = 0;
  std::shared_ptr<const OccupancyGrid> map;
};

struct SimulatedSignal {
  SignalLog log;                             ///< radios robot1, robot2, ...
  std::shared_ptr<const OccupancyGrid> map;  ///< as the robots knew it at the end
  std::vector<TimedMap> maps;                ///< by time, that one the last
  FloorPlan plan;                            ///< the truth: what is where
  std::vector<double> bias_db, sending_bias_db, listening_bias_db;  ///< of radios
  std::vector<std::vector<StampedPose>> trajectories;  ///< of robots, one pose a second
};

/// Same options, same digits.  Throws Error (kUsage) as Check does, and where a robot finds no
/// place to stand.
SimulatedSignal SimulateSignal(const SignalMissionOptions& options);

/// What a class of a map's cells truly attenuates in each coarse cell [dB/m], the mean over the
/// cells of the class in it: what an AttenuationCell estimates.
struct TrueAttenuation {
  Occupancy what;
  std::int32_t x, y;  ///< of the coarse cell
  double db_per_m;
  std::size_t cells;  ///< of the map, of that class
};
std::vector<TrueAttenuation> TrueAttenuations(const FloorPlan& plan, const OccupancyGrid& map,
                                              double coarse_m);

}  // namespace graticule
