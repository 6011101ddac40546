#pragma once

#include <string>

#include "graticule/problems/pose_graph/landmarks.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

/// Poses are solved for as soon as those that have come may be turned by more than is linear: where
/// the standard deviation of their rotation, from odometry alone, passes online.relinearise_above
/// (radians).  Positions do not matter, residuals are linear in them.
struct IncrementalOptions {
  IncrementalOptions() { online.relinearise_every = 1; }

  /// At the latest after so many, for the noise may be stated too small.  On victoria_park 10 to
  /// 1000 lead to the same minimum; 50 take a third of the time that 10 take, and the last solve
  /// begins within 1e-4 of it.
  int poses_an_update = 50;
  /// What may be spent, in variables eliminated for each that has come: the steps that Solve takes
  /// by default eliminate as many.  Where more is spent, updates wait for more poses.
  double work = 100;
  OnlineOptions online;
};

struct IncrementalReport {
  std::size_t poses = 0, roots = 0, free_roots = 0;  ///< as SpanningTreeReport
  PlacedLandmarks landmarks;
  std::size_t updates = 0;
  bool is_complete = true;  ///< false: `failure`, or the observer said stop
  std::string failure;      ///< why it was given up; what had not come was placed unsolved
};

/// Places the poses and landmarks of a graph by solving it as it grew (Replay).  Where a start that
/// looks at all measurements at once has to average over what odometry drifts off, here each loop
/// is closed from values that the loops before it have corrected.
///
/// It follows odometry: factors between consecutive keys should be the more reliable ones.
/// Where the values do not stay finite they are left as they were.  `watch` sees a row an update,
/// its objective nan.  Same input, same digits.
IncrementalReport PlaceIncrementally(const Graph& graph, Values* values,
                                     const IncrementalOptions& options = {},
                                     const Observer& watch = {});

}  // namespace graticule
