#pragma once

#include <cstdint>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// A city of square blocks, in which robots drive along the streets and turn at random corners.
struct CityOptions {
  int dimension = 2;  ///< 2: se2/1, between_se2/1; 3: se3/1, between_se3/1, on hilly streets
  int robots = 4;
  int poses_per_robot = 1000;
  int blocks = 0;            ///< along each side; 0: so many that a street is driven about twice
  double block_m = 20;       ///< side of a block; a whole number of steps
  double step_m = 2;         ///< from pose to pose
  double hill_height_m = 3;  ///< of 3D streets, with about 100 m from top to top

  double odometry_sigma_m = 0.05;
  double odometry_sigma_rad = 0.005;
  double closure_sigma_m = 0.1;
  double closure_sigma_rad = 0.01;
  /// A closure joins poses that are at most this far apart.
  double closure_range_m = 5;
  /// Closures a pose, on average: with the same robot, at least `loop_min_gap` poses apart, and
  /// with another robot.  No pair twice; fewer where the town has hardly any more.
  double loops_per_pose = 0.5;
  double inter_robot_per_pose = 0.2;
  int loop_min_gap = 50;
  /// Share of the closures that are wrong: a place within range, in no relation to the truth.
  double outlier_fraction = 0;

  int landmarks = 0;
  double landmark_range_m = 8;
  double landmark_sigma_m = 0.1;
  double sightings_per_pass = 0.5;  ///< chance that a landmark in range is seen from a pose

  /// How far off the robots believe to start, but for the first, which is fixed at the truth.
  double start_sigma_m = 5;
  double start_sigma_rad = 0.1;
  std::uint64_t seed = 1;
};

struct Simulated {
  Graph graph;   ///< initial values: each robot's odometry from where it believes to start
  Values truth;  ///< of the graph's variables, in its layout
  std::vector<FactorId> outliers;  ///< closures that are wrong; the graph itself does not say
};

/// A multi-robot pose graph with truth: families `robot1` .. and `landmark`; sources "odometry",
/// "loop", "inter_robot", "sighting".
///
/// A measurement is truth * inverse(noise), so that at the truth the residual is the noise itself:
/// chi2 of the inliers there is chi-square distributed, with no linearisation.
/// Same options, same digits.  Time and memory in proportion to poses, closures and sightings.
/// Throws Error (kUsage) where an option makes no sense.
Simulated SimulateCity(const Registry& types, const CityOptions& options = {});

}  // namespace graticule
