#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "graticule/solver/block_system.hpp"
#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/parallel_evaluation.hpp"

namespace graticule {

/// J' J and J' r of a graph's whitened residuals, weighted by their losses' rho': a block a
/// variable, in place in a BlockSystem, with no Jacobian kept.
///
/// Tangent vectors hold the free variables in key order.
class NormalEquations {
 public:
  /// Variables in `is_held` (by VariableId) are constants.  `replaced` stands in for every factor's
  /// loss.  With `threads` > 1 the factors are evaluated by several; sums are in the factors' order
  /// all the same.
  NormalEquations(const Evaluation& evaluation, const std::optional<Loss>& replaced,
                  const std::vector<char>& is_held, int threads);

  /// Blocks between two different variables, counted with their repetitions: what the plan of a
  /// graph costs.
  static std::size_t CountPairs(const Graph& graph);

  int Size() const { return system_->Size(); }
  BlockSystem& System() { return *system_; }
  /// J' r where the equations were last made.
  const std::vector<double>& Gradient() const { return gradient_; }
  /// r' r of every factor there.
  const std::vector<double>& Chi2() const { return chi2_; }

  /// Makes the equations at `data`, laid out as the graph's values.  Gives 0.5 sum rho(r' r); false
  /// where a factor cannot be evaluated.
  bool Linearise(const double* data, double* objective);
  /// The objective alone.
  bool Objective(const double* data, double* objective);

  /// moved = data plus a step.
  void Plus(const double* data, const double* step, double* moved) const;
  /// Length of the free variables' stored numbers.
  double Norm(const double* data) const;

 private:
  static constexpr int kHeld = -1;
  void Add(FactorId id, const double* residual, const double* jacobians);

  const Evaluation& evaluation_;
  std::optional<Loss> replaced_;
  std::vector<VariableId> free_;     // by node
  std::vector<int> nodes_;           // a factor's blocks, one factor after the other; kHeld
  std::vector<std::size_t> firsts_;  // by factor: into nodes_
  std::vector<std::size_t> links_;   // by factor: the first of its pairs of free blocks
  std::vector<double> gradient_, chi2_;
  std::vector<double> scratch_;  // residual and Jacobians of one factor
  std::unique_ptr<BlockSystem> system_;
  std::unique_ptr<ParallelEvaluation> parallel_;
};

}  // namespace graticule
