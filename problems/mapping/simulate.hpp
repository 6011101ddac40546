#pragma once

#include <cstdint>
#include <vector>

#include "graticule/problems/mapping/mission.hpp"
#include "graticule/problems/mapping/town.hpp"

namespace graticule {

/// A team of robots that explores a town with people and vehicles in it.
struct MissionOptions {
  TownOptions town;
  int robots = 4;
  double duration_s = 600;
  double scan_every_s = 1;
  double speed_m_s = 0.6;
  double node_every_m = 1;      ///< a node of the pose graph a so many metres, or ...
  double node_every_rad = 0.5;  ///< ... turned so far

  int beams = 181;  ///< over 180 degrees, ahead
  double max_range_m = 30;
  double range_sigma_m = 0.015;
  double no_return = 0.005;  ///< share of beams that see nothing, as glass does

  double odometry_sigma = 0.02;        ///< of the metres driven
  double odometry_sigma_rad_m = 0.01;  ///< rad, after a metre
  double odometry_sigma_turn = 0.02;   ///< of the angle turned
  /// Of the graph's factors: scans matched one after the other, and loop closures.
  double match_sigma_m = 0.02, match_sigma_rad = 0.003;
  double closure_range_m = 4;
  double radio_range_m = 40;  ///< robots further apart close no loop with each other

  int people = 30, vehicles = 6;
  std::uint64_t seed = 1;
};

struct SimulatedMission {
  /// The log by time; robots `robot1` ..; odometry drifts.  The graph is what a front end would
  /// make of it: se2/1 `robot1:0` .., priors where the robots start, between_se2/1 factors with the
  /// sources "scan" and "loop".
  Mission mission;
  std::vector<PlanarPose> world_from_robot;  ///< of every scan: the truth
  Town town;
  /// Cells of the town where somebody walked or drove during the mission.
  std::vector<std::uint8_t> is_swept;
};

/// Same options, same digits.  Throws Error (kUsage) where an option makes no sense.
SimulatedMission SimulateMission(const Registry& types, const MissionOptions& options);

/// Missions of the shapes of the thesis' sets (Table 2.2), which are not public: 10 robots in
/// 150 x 150 m with 68 graphs, and 14 robots in 220 x 160 m with 429
/// graphs in 72 minutes, one every 10 s.
MissionOptions KeswickLike();
MissionOptions Phase2Like();

}  // namespace graticule
