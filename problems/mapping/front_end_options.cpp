#include "graticule/problems/mapping/front_end.hpp"

namespace graticule {

const std::vector<OptionRow<FrontEndOptions>>& FrontEndOptionTable() {
  using Options = FrontEndOptions;
  static const std::vector<OptionRow<Options>> table = {
      NumberOption("node_distance", &Options::node_distance, true,
                   "a node after so many metres of the way"),
      NumberOption("node_turn", &Options::node_turn, true, "or after a turn of so many radians"),
      NumberOption("odometry_sigma", &Options::odometry_sigma, true,
                   "standard deviation of a step of dead reckoning [m]"),
      NumberOption("odometry_sigma_per_metre", &Options::odometry_sigma_per_metre, false,
                   "what it grows by, a metre of the step [m]"),
      NumberOption("odometry_sigma_yaw", &Options::odometry_sigma_yaw, true,
                   "standard deviation of a step's turn [rad]"),
      NumberOption("odometry_sigma_per_turn", &Options::odometry_sigma_per_turn, false,
                   "what it grows by, a radian of the turn [rad]"),
      NumberOption("max_range", &Options::max_range, true,
                   "readings from this range on are not used [m]"),
      NumberOption("point_spacing", &Options::point_spacing, false,
                   "points of a scan are thinned to this distance [m]"),
      IntegerOption("local_nodes", &Options::local_nodes, 1,
                    "nodes that a scan is matched against, besides some older ones"),
      NumberOption("drift_sigma", &Options::drift_sigma, true,
                   "error of a match with the nodes before, besides what its points say [m]"),
      NumberOption("drift_sigma_yaw", &Options::drift_sigma_yaw, true, "the same, in yaw [rad]"),
      NumberOption("closure_reach", &Options::closure_reach, true,
                   "places this far apart, or farther but uncertain, are compared [m]"),
      NumberOption("closure_window", &Options::closure_window, true,
                   "the farthest from where it should be that a place is looked for [m]"),
      NumberOption("closure_score", &Options::closure_score, true,
                   "mean likelihood that a closure's points must have (0 to 1)"),
      NumberOption("closure_sigma", &Options::closure_sigma, true,
                   "error of a closure, besides what its points say [m]"),
      NumberOption("closure_sigma_yaw", &Options::closure_sigma_yaw, true,
                   "the same, in yaw [rad]"),
      IntegerOption("closure_rounds", &Options::closure_rounds, 0,
                    "how often closures are looked for, at most"),
      IntegerOption("overlap_rounds", &Options::overlap_rounds, 0,
                    "how often all that overlaps is matched at the end"),
      IntegerOption("threads", &Options::threads, 0, "0: as many as the machine has"),
      NumberOption("start_sigma", &Options::start_sigma, true,
                   "error of where a robot is said to begin [m]"),
      NumberOption("start_sigma_yaw", &Options::start_sigma_yaw, true, "the same, in yaw [rad]"),
  };
  return table;
}

}  // namespace graticule
