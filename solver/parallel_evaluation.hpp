#pragma once

#include <vector>

#include "graticule/solver/evaluation.hpp"

namespace graticule {

/// All factors' whitened residuals and Jacobians at one point, computed by several threads.  Each
/// thread has a fixed share of the factors, and nothing is added up: the digits do not depend on
/// the number of threads.
class ParallelEvaluation {
 public:
  /// `data` is laid out as the graph's values, and is read anew at each Prepare.
  ParallelEvaluation(const Evaluation& evaluation, const double* data, int threads);

  void Prepare(bool with_jacobians);

  /// What Prepare found for one factor.  Jacobians have the stored sizes of the blocks as their
  /// strides (columns beyond the tangent are zero), as CeresBridge wants them.  False where the
  /// factor failed.
  bool Copy(FactorId id, double* residual, double** jacobians) const;

 private:
  void Work(FactorId begin, FactorId end, bool with_jacobians);

  const Evaluation& evaluation_;
  const double* data_;
  int threads_ = 1;
  std::vector<std::size_t> offset_;
  std::vector<double> storage_;
  std::vector<char> good_;  // not bits: threads write neighbours
};

}  // namespace graticule
