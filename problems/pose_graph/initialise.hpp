#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"
#include "graticule/solver/option.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

/// Where a pose graph's initial values come from.
enum class InitialGuess {
  kAutomatic,     ///< the best of the file's, chordal and spanning tree; see Initialise
  kFile,          ///< as they are
  kOdometry,      ///< along consecutive keys of a family; the tree for what that does not reach
  kSpanningTree,  ///< breadth first over all between factors: the fewest measurements to each pose
  kMinimumSpanningTree,  ///< of the traces of the between factors' covariances
  kChordal,      ///< rotations, then translations, by linear least squares: see PlaceByChordal
  kLago,         ///< of the plane: angles, then poses, by linear least squares: see PlaceByLago
  kIncremental,  ///< solved pose by pose, as the graph grew: see PlaceIncrementally
};

struct InitialiseOptions {
  InitialGuess initialise = InitialGuess::kAutomatic;
};

/// The one description of InitialiseOptions.
const std::vector<OptionRow<InitialiseOptions>>& InitialiseOptionTable();

/// What a candidate would begin with: 0.5 sum rho(r' W r), nan where it cannot be evaluated.  Of
/// one that was not chosen, as much of it as told.
struct InitialCost {
  InitialGuess guess;
  double cost;
};

struct InitialiseReport {
  InitialGuess used = InitialGuess::kFile;
  std::size_t set = 0;        ///< variables that were given a new value: poses + landmarks
  std::size_t poses = 0;      ///< of these, poses
  std::size_t landmarks = 0;  ///< of these, landmarks
  std::size_t roots = 0;      ///< poses that others were placed from
  /// Roots that nothing holds: the smallest key of a piece without a fixed pose or a prior.
  std::size_t free_roots = 0;
  std::size_t assumed = 0;  ///< of the landmarks, those at an assumed range or direction
  /// Pieces that chordal or lago left to the spanning tree, for want of measurements.
  std::size_t kept_pieces = 0;
  std::size_t updates = 0;  ///< of incremental
  std::string failure;      ///< why incremental was given up; what had not come was placed unsolved
  std::vector<InitialCost> candidates;  ///< what automatic chose from; empty where it had no choice
  std::string summary;                  ///< one line
};

/// Gives the poses (se2/1, se3/1) and landmarks (point2/1, point3/1) of a graph initial values from
/// its measurements.  Fixed variables keep theirs.
///
/// Roots are the fixed poses, poses with a prior (placed where it says), and then the smallest key
/// of each piece that is still unplaced, at its own value.  Landmarks come last, from their first
/// sighting; of a landmark with bearings only, from the two that cross best, and where none cross
/// well at an assumed 10 m; of one with ranges only, straight ahead.  The report says how many.
/// Chordal places landmarks together with the poses where their sightings say all of them.
/// Pieces that only landmarks or positions (position_*) tie together are not aligned.
///
/// A graph without such poses (bundle adjustment) is left untouched, and the summary says so.
/// `file_has_guess` is what the reader of the file says.
///
/// Automatic, where between and landmark factors close no loop: the file's where it has them, else
/// the spanning tree.  Where they do: of the file's (if any), chordal and the spanning tree, the
/// one of the least cost 0.5 sum rho(r' W r).
///
/// Automatic tries neither lago, which is there to compare with, nor incremental, which takes many
/// times as long as the others and is tried by InitialiseAndSolve where it may help.  `watch` sees
/// a row for each update of incremental; where it says stop, the rest is placed unsolved.  Throws
/// Error (kUsage) where lago meets a pose in space.
///
/// Deterministic.  Time in proportion to the graph, but for the sorting of keys and the two sparse
/// factorisations of chordal and lago.
InitialiseReport Initialise(Graph* graph, InitialGuess how, bool file_has_guess,
                            const Observer& watch = {});

/// "automatic", "file", "odometry", "spanning_tree".
std::string ToString(InitialGuess guess);

}  // namespace graticule
