#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

/// A graph as a ceres::Problem.  The only place that says `ceres::`.
///
/// Jacobians reach Ceres already in the tangent: a block of stored size n and tangent size m is
/// written as n columns of which the last n - m are zero, and its manifold's plus-Jacobian is [I;
/// 0].  Ceres then works in our tangent space, and one Jacobian serves solver, marginals and
/// checks.
///
/// Ceres itself always runs on one thread, for its sums are not added in a fixed order on more.
/// With options.threads > 1 the factors are evaluated beforehand, each thread a fixed share.
class CeresBridge {
 public:
  /// Whether eliminating variables of one type (points that cameras see) pays: it removes most of
  /// the unknowns.
  static bool EliminationPays(const Graph& graph, const std::vector<char>& is_held);

  /// `data` is laid out as the graph's values, and holds the result after Run.  Variables in
  /// `is_held` (by VariableId) stay as they are. `replaced` stands in for every factor's loss.
  /// Throws Error (kUsage) where options do not go together.
  CeresBridge(const Evaluation& evaluation, const SolveOptions& options,
              const std::optional<Loss>& replaced, const std::vector<char>& is_held,
              std::vector<double>* data);
  ~CeresBridge();

  /// Fills termination, message, iterations, objectives, linear_solver, parameters and the inner
  /// timings.
  void Run(const Observer& watch, Report* report);

 private:
  struct Machine;
  std::unique_ptr<Machine> machine_;
};

/// "2.1.0-eigen-(3.4.0)-..."
std::string CeresVersion();

}  // namespace graticule
