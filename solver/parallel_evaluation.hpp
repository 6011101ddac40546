#pragma once

#include <vector>

#include "graticule/solver/evaluation.hpp"

namespace graticule {

/// All factors' whitened residuals and Jacobians at one point, computed by several threads.  Each
/// thread has a fixed share of the factors, and nothing is added up: the digits do not depend on
/// the number of threads.
class ParallelEvaluation {
 public:
  /// Numbers from row to row of a Jacobian.
  enum class Stride {
    kStored,   ///< the block's stored size: columns beyond the tangent are zero
    kTangent,  ///< its tangent size: packed
  };
  ParallelEvaluation(const Evaluation& evaluation, Stride stride, int threads);

  /// At `data`, laid out as the graph's values.
  void Prepare(const double* data, bool with_jacobians);

  /// What Prepare found for one factor: its residual, then a Jacobian a block, row-major.  Null
  /// where the factor failed.
  const double* At(FactorId id) const {
    return good_[id] ? storage_.data() + offset_[id] : nullptr;
  }
  double* At(FactorId id) { return good_[id] ? storage_.data() + offset_[id] : nullptr; }
  /// The same, each to its place; Jacobians that are null are not wanted.
  bool Copy(FactorId id, double* residual, double** jacobians) const;

 private:
  int StrideOf(VariableId variable) const;
  void Work(const double* data, FactorId begin, FactorId end, bool with_jacobians);

  const Evaluation& evaluation_;
  Stride stride_;
  int threads_ = 1;
  std::vector<std::size_t> offset_;
  std::vector<double> storage_;
  std::vector<char> good_;  // not bits: threads write neighbours
};

}  // namespace graticule
