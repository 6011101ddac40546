#pragma once

#include <optional>

#include "configuration.hpp"
#include "graticule/io/second_look_summary.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule::apps {

/// Places a graph's initial values and solves it as a configuration says, its outliers left out
/// where it says so.
struct ConfiguredSolution {
  Solution solution;
  RejectionReport rejection;   ///< of method none where nothing was looked for
  std::vector<bool> is_kept;   ///< by factor; empty: all
  std::string initialisation;  ///< one line
  std::string start_label;     ///< "chordal", "trusted factors"
  PhaseTime initialise;
  std::optional<SecondLookSummary> second_look;
};

/// Sets the graph's values to what the solve starts from.  Throws Error.
ConfiguredSolution SolveAsConfigured(Graph* graph, bool file_has_guess,
                                     const Configuration& configuration, const Observer& watch);

/// The question that was solved: the graph with the loss that the options put in the place of its
/// factors' own, where they name one.  What certificates and covariances are of.
Graph AsSolved(const Graph& graph, const SolveOptions& options);

}  // namespace graticule::apps
