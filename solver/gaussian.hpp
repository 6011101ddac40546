#pragma once

#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// The factor type of the same name: a Gaussian over any variables, as marginalising others leaves
/// it.  Residual R (x [-] x0) - b, without unit; x [-] x0 is all its variables' tangent, one after
/// the other.  Measured: the numbers of rows and columns of R, x0, R row by row, b.
constexpr const char* kGaussian = "gaussian/1";
FactorType GaussianType();
/// Whether this is its table.  Only the host can evaluate it: it needs the variables' manifolds.
bool IsGaussian(const graticule_factor_type_v1* table);

/// The same as a value.
struct Gaussian {
  int rows = 0, columns = 0;
  std::vector<double> point;  ///< x0: the fields of its variables, one after the other
  std::vector<double> r;      ///< rows x columns, row-major
  std::vector<double> b;

  std::vector<double> Measurement() const;
  /// "", or why it cannot be of these variables.
  std::string Misfit(const Graph& graph, Span<const VariableId> variables) const;
  /// Residual and, where `jacobians` and its entries are not null, Jacobians with respect to each
  /// variable's tangent at `blocks`: row-major, `strides[i]` numbers from row to row.
  void Evaluate(const Graph& graph, Span<const VariableId> variables, const double* const* blocks,
                double* residual, double* const* jacobians, const int* strides) const;
};

}  // namespace graticule
