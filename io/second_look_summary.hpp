#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace graticule {

/// How a solution that its noise does not explain was looked at again.
struct SecondLookSummary {
  std::string text;  ///< one line
  double reduced_chi2 = 0;

  /// What came of a start.
  struct Solve {
    std::string start, termination;
    double objective = 0, seconds = 0;
    std::size_t iterations = 0;
  };
  Solve first;
  std::string verdict;             ///< of the certificate; "" where none was asked for
  double certificate_seconds = 0;  ///< wall
  std::optional<Solve> second;
  bool improved = false;     ///< the solution is the second
  bool was_stopped = false;  ///< by Ctrl-C or the time limit
};

}  // namespace graticule
