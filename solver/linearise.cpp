#include "graticule/solver/linearise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/solver/error.hpp"

namespace graticule {

TangentIndex::TangentIndex(const Graph& graph, const std::vector<VariableId>& anchors)
    : first(graph.VariableCount(), 0) {
  for (const VariableId id : anchors) first[id] = kHeld;
  for (const VariableId id : graph.KeyOrder()) {
    if (graph.IsFixed(id)) first[id] = kHeld;
    if (first[id] == kHeld) continue;
    first[id] = size;
    size += graph.TypeOf(id).TangentSize();
    variable_of.resize(static_cast<std::size_t>(size), id);
  }
}

Cholmod::Cholmod() {
  cholmod_start(&common_);
  common_.print = 0;
  common_.error_handler = nullptr;
  common_.try_catch = 1;
}

Cholmod::~Cholmod() { cholmod_finish(&common_); }

cholmod_sparse SparseColumns::View() const {
  cholmod_sparse view{};
  view.nrow = static_cast<std::size_t>(rows);
  view.ncol = static_cast<std::size_t>(Columns());
  view.nzmax = row.size();
  view.p = const_cast<int*>(column_begin.data());
  view.i = const_cast<int*>(row.data());
  view.x = const_cast<double*>(value.data());
  view.stype = 0;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 0;
  view.packed = 1;
  return view;
}

std::vector<double> SparseColumns::ScaleRows() {
  std::vector<double> scale(static_cast<std::size_t>(rows), 0.0);
  for (std::size_t k = 0; k < row.size(); ++k)
    scale[static_cast<std::size_t>(row[k])] += value[k] * value[k];
  for (double& s : scale) s = s > 0 ? 1 / std::sqrt(s) : 1;
  for (std::size_t k = 0; k < row.size(); ++k) value[k] *= scale[static_cast<std::size_t>(row[k])];
  return scale;
}

cholmod_dense DenseView(double* values, std::size_t rows, std::size_t columns) {
  cholmod_dense view{};
  view.nrow = view.d = rows;
  view.ncol = columns;
  view.nzmax = rows * columns;
  view.x = values;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  return view;
}

SparseColumns TransposedJacobian(const Evaluation& evaluation, const double* data,
                                 const TangentIndex& index) {
  const Graph& graph = evaluation.TheGraph();
  SparseColumns matrix;
  matrix.rows = index.size;
  std::size_t columns = 0, entries = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const auto rows = static_cast<std::size_t>(graph.ResidualSize(id));
    columns += rows;
    for (const VariableId variable : graph.FactorAt(id).variables)
      if (index.first[variable] != TangentIndex::kHeld)
        entries += rows * static_cast<std::size_t>(graph.TypeOf(variable).TangentSize());
  }
  if (columns > std::numeric_limits<int>::max() || entries > std::numeric_limits<int>::max())
    throw Error("the problem is too large for 32-bit sparse matrices", ErrorKind::kOther);
  matrix.column_begin.reserve(columns + 1);
  matrix.row.reserve(entries);
  matrix.value.reserve(entries);

  std::vector<const double*> blocks;
  std::vector<double> storage, residual;
  std::vector<double*> jacobians;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const int rows = graph.ResidualSize(id);
    evaluation.Blocks(id, data, &blocks);
    std::size_t needed = 0;
    for (const VariableId variable : factor.variables)
      needed += static_cast<std::size_t>(rows * graph.TypeOf(variable).TangentSize());
    storage.resize(needed);
    residual.resize(static_cast<std::size_t>(rows));
    jacobians.clear();
    std::size_t offset = 0;
    for (const VariableId variable : factor.variables) {
      const bool held = index.first[variable] == TangentIndex::kHeld;
      jacobians.push_back(held ? nullptr : storage.data() + offset);
      offset += static_cast<std::size_t>(rows * graph.TypeOf(variable).TangentSize());
    }
    if (!evaluation.Whitened(id, blocks.data(), residual.data(), jacobians.data(), nullptr))
      throw Error(evaluation.FirstFailure(), ErrorKind::kOther);
    double chi2 = 0, rho[3];
    for (const double r : residual) chi2 += r * r;
    EvaluateLoss(factor.loss, chi2, rho);
    const double weight = std::sqrt(std::max(rho[1], 0.0));
    for (int r = 0; r < rows; ++r) {
      for (std::size_t b = 0; b < factor.variables.size(); ++b) {
        if (!jacobians[b]) continue;
        const int size = graph.TypeOf(factor.variables[b]).TangentSize();
        for (int c = 0; c < size; ++c) {
          matrix.row.push_back(index.first[factor.variables[b]] + c);
          matrix.value.push_back(weight * jacobians[b][r * size + c]);
        }
      }
      matrix.column_begin.push_back(static_cast<int>(matrix.row.size()));
    }
  }
  return matrix;
}

}  // namespace graticule
