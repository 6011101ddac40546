#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graticule/solver/factor.hpp"
#include "graticule/solver/key.hpp"

namespace graticule {

enum class Termination {
  kConverged,      ///< a tolerance was met
  kNoConvergence,  ///< max_iterations reached
  kTimeLimit,      ///< time_limit_s reached
  kCancelled,      ///< the observer said stop
  kFailed,         ///< a factor could not be evaluated, or the linear solver gave up
};

/// One step of the solver.  Row 0 is the initial guess.
struct Iteration {
  int number = 0;
  bool accepted = true;
  double objective = 0;         ///< 0.5 sum rho(r' W r)
  double objective_change = 0;  ///< decrease against the row before; negative: step rejected
  double gradient_max_norm = 0;
  double step_norm = 0;
  double trust_region_radius = 0;
  int linear_iterations = 0;
  bool reused_factor = false;  ///< solved for with the factorisation of a step before
  double seconds = 0;          ///< wall time since Solve began
};

/// Cost of all factors of one type and source together.
struct CostShare {
  std::string type;
  std::string source;
  std::size_t factors = 0;
  std::size_t residuals = 0;
  double initial_cost = 0;  ///< 0.5 r' W r
  double final_cost = 0;
};

/// A factor that disagrees most.
struct WorstFactor {
  FactorId id = 0;
  std::string type;
  std::string source;
  std::vector<Key> keys;
  double chi2 = 0;  ///< r' W r at the end
  int residuals = 0;
  double weight = 1;  ///< rho': what the loss left of it
};

/// Wall and CPU seconds (of all threads) of one phase.
struct PhaseTime {
  double wall = 0;
  double cpu = 0;
};

/// Where the time went.  Load, initialise and write are filled in by whoever does them.
struct Timing {
  PhaseTime load, initialise, build, solve, write, total;
  double preprocess = 0;    ///< wall, inside solve: ordering and set-up by Ceres
  double evaluate = 0;      ///< wall, inside solve: residuals and Jacobians
  double linear_solve = 0;  ///< wall, inside solve
};

/// What Solve did: enough to judge it, and to repeat it.
struct Report {
  Termination termination = Termination::kFailed;
  std::string message;  ///< one line: why it ended

  std::size_t variables = 0, fixed_variables = 0, factors = 0, residuals = 0, parameters = 0;
  /// Residuals minus free tangent parameters; may be negative.
  long long degrees_of_freedom = 0;

  double initial_cost = 0;       ///< 0.5 r' W r at the start, without losses
  double final_cost = 0;         ///< 0.5 r' W r at the end, without losses
  double initial_objective = 0;  ///< 0.5 sum rho(r' W r): what was minimised
  double final_objective = 0;
  double Chi2() const { return 2 * final_cost; }
  /// chi2 per degree of freedom; nan where there is none.
  double ReducedChi2() const;

  std::vector<Iteration> iterations;
  /// Accepted and rejected steps.
  std::size_t Steps() const { return iterations.empty() ? 0 : iterations.size() - 1; }

  std::vector<CostShare> shares;
  std::vector<WorstFactor> worst;    ///< largest chi2 first, at most five
  std::vector<std::string> anchors;  ///< keys held fixed by the solver to remove the gauge
  std::vector<std::string> warnings;

  Timing timing;
  int threads = 1;
  std::string linear_solver;  ///< what was used: "sparse_normal_cholesky (suite_sparse, amd)"
  std::vector<std::pair<std::string, std::string>> options;  ///< every option's name and value
  std::vector<std::pair<std::string, std::string>>
      provenance;  ///< versions of Graticule, Ceres, BLAS
};

/// "converged", "no_convergence", "time_limit", "cancelled", "failed".
std::string ToString(Termination termination);

}  // namespace graticule
