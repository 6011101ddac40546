#pragma once

#include <cholmod.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "graticule/solver/evaluation.hpp"

namespace graticule {

/// Which rows of a linear system a graph's free variables own: key order, tangent sizes.
struct TangentIndex {
  static constexpr int kHeld = -1;
  std::vector<int> first;  ///< by VariableId; kHeld where the variable is fixed or an anchor
  int size = 0;
  std::vector<VariableId> variable_of;  ///< by row

  TangentIndex(const Graph& graph, const std::vector<VariableId>& anchors);
};

/// Owns CHOLMOD's workspace.
class Cholmod {
 public:
  Cholmod();
  ~Cholmod();
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;
  cholmod_common* operator()() { return &common_; }

 private:
  cholmod_common common_;
};

/// A sparse matrix by columns.
struct SparseColumns {
  int rows = 0;
  std::vector<int> column_begin{0};
  std::vector<int> row;
  std::vector<double> value;

  int Columns() const { return static_cast<int>(column_begin.size()) - 1; }
  /// A view for CHOLMOD; unsymmetric.
  cholmod_sparse View() const;
  /// Brings every row that is not zero to unit length.  Returns what each was multiplied by; 1 for
  /// rows that are zero.
  std::vector<double> ScaleRows();
};

/// A view for CHOLMOD of rows x columns numbers, by columns.
cholmod_dense DenseView(double* values, std::size_t rows, std::size_t columns);

/// The transposed whitened Jacobian at `data` (laid out as the graph's values): a column a
/// residual, each factor scaled by the root of its loss' weight rho'.  Throws Error (kOther) where
/// a factor cannot be evaluated.
SparseColumns TransposedJacobian(const Evaluation& evaluation, const double* data,
                                 const TangentIndex& index);

}  // namespace graticule
