#pragma once

#include <optional>
#include <string>

#include "graticule/problems/pose_graph/certify.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

/// What came of a start.
struct StartedSolve {
  InitialGuess start = InitialGuess::kFile;
  Termination termination = Termination::kFailed;
  double objective = 0;  ///< 0.5 sum rho(r' W r) at its end
  std::size_t iterations = 0;
  double seconds = 0;  ///< wall: start and solve
};

/// How a solution that its noise does not explain was looked at again.
struct SecondLook {
  double reduced_chi2 = 0;  ///< of the first solution
  StartedSolve first;
  std::optional<Certificate> certificate;  ///< of the first; none where it had not converged
  double certificate_seconds = 0;          ///< wall
  std::optional<StartedSolve> second;      ///< from the incremental start, where that was solved
  bool improved = false;                   ///< the solution is the second
  bool was_stopped = false;                ///< by the observer or the time limit
  std::string summary;                     ///< one line for people
};

struct PoseGraphSolution {
  Solution solution;
  InitialiseReport start;  ///< of this solution
  PhaseTime initialise;    ///< of all starts together
  std::optional<SecondLook> second_look;
};

/// Initialise, then Solve; and where the default's solution fits worse than its noise allows, from
/// another start.  The graph's values are then those that the solution was found from.
///
/// A second look is taken where `how` is automatic, no factor has a loss, and chi2 is beyond the
/// 1 - 1e-6 quantile of the chi-square distribution of its degrees of freedom.  Either the noise is
/// stated too small, or this is not the minimum.  If Certify proves that it is, that is all; else
/// (refused, not settled, not applicable) the graph is solved from an incremental start, and the
/// solution of least objective is kept.  A solve that did not converge is not certified.  One that
/// was cut short on purpose is left as it is: by the time limit, by the observer, or by fewer
/// iterations than the default's.
///
/// solve.time_limit_s holds for all of it together but the certificate, which is not begun after
/// it.  `watch` sees the iterations of all solves, and the updates of the incremental start, with
/// the objective of the first solution; where it says stop, the best so far is the result.
/// Throws Error as Initialise and Solve do.
PoseGraphSolution InitialiseAndSolve(Graph* graph, InitialGuess how, bool file_has_guess,
                                     const SolveOptions& solve = {}, const Observer& watch = {});

}  // namespace graticule
