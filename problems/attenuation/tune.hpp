#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace graticule {

struct CompassOptions {
  double first_step = 1;             ///< in each coordinate, before halving
  double last_step = 0.01;           ///< the search ends when a smaller step would be next
  std::vector<double> scale;         ///< of each coordinate's step; empty: 1
  std::vector<double> lower, upper;  ///< bounds; empty: none
  /// With those that a state file remembers, and at least one: what does not fit is not begun.
  std::size_t max_evaluations = 1000;
  std::size_t threads = 1;  ///< the function is then called from so many at once
  /// Where every value that was found is kept, so that a search which was stopped goes on where it
  /// was.  Empty: nowhere.  A file of another search is refused.
  std::string state_path;
  /// One word for what the function depends on beside its arguments: a file of another is refused.
  std::string state_of;
};

struct CompassResult {
  std::vector<double> best;
  double value = 0, start_value = 0;  ///< nan: stopped before it was found
  std::size_t evaluations = 0;        ///< without those that a state file remembered
  bool has_converged = false;         ///< false: max_evaluations came first, or it was stopped
  bool was_stopped = false;  ///< a value was left out; the best is of those that were found
};

/// Finds the function's values at points, in whatever order, and says each as it is found, one at a
/// time.  It may leave some out: then the search has been stopped.
using CompassFound = std::function<void(std::size_t point, double value)>;
using CompassEvaluate =
    std::function<void(const std::vector<std::vector<double>>& points, const CompassFound& found)>;

/// Compass search (coordinate descent with halving steps; thesis 3.3.1) for the least value of a
/// function.  In each round every coordinate is tried up and down, all from the round's best point,
/// then all of them that gained together, and the least is taken; no gain: the step is halved.
/// Values that are not finite count as infinite.  The result does not depend on the number of
/// threads.  Throws Error: sizes that do not fit (kUsage), a state file that is not one or is
/// another search's (kInput).
CompassResult CompassSearch(const std::function<double(const std::vector<double>&)>& value,
                            const std::vector<double>& start, const CompassOptions& options);

/// The same, by whoever finds the values of a round's points: `threads` counts for nothing.
CompassResult CompassSearch(const CompassEvaluate& evaluate, const std::vector<double>& start,
                            const CompassOptions& options);

}  // namespace graticule
