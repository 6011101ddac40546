#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

/// Levenberg-Marquardt with Ceres' damping and tolerances (Madsen, Nielsen, Tingleff 2004), on
/// block normal equations that CHOLMOD factorises in place.
///
/// It goes beyond Ceres in two ways, both without a factorisation:
/// - Where the new equations agree with the old along the step that the last factorisation gives,
///   that step is taken (a simplified Newton step), or found to be too small to matter.
/// - An undamped step that raises the objective is shortened, once, before damping begins.
class DirectMinimiser {
 public:
  /// Whether these options can be served: damped or undamped Gauss-Newton steps by sparse Cholesky
  /// with CHOLMOD.
  static bool Serves(const SolveOptions& options);

  /// As CeresBridge.  The options must outlive it.
  DirectMinimiser(const Evaluation& evaluation, const SolveOptions& options,
                  const std::optional<Loss>& replaced, const std::vector<char>& is_held,
                  std::vector<double>* data);
  ~DirectMinimiser();

  /// As CeresBridge.
  void Run(const Observer& watch, Report* report);

  /// r' r of every factor before and after; empty where it is not known.
  std::vector<double> TakeInitialChi2();
  std::vector<double> TakeFinalChi2();

 private:
  class Machine;
  std::unique_ptr<Machine> machine_;
};

}  // namespace graticule
