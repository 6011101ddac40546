#include "graticule/solver/gaussian.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace graticule {
namespace {

void Say(graticule_error* error, const char* what) {
  std::snprintf(error->message, sizeof(error->message), "%s", what);
}

// to = from' D, with the size known where it can be: poses are most of what there is.
template <int kSize>
void ApplyOf(const double* from, const double* d, double* to) {
  double sum[kSize] = {};
  for (int k = 0; k < kSize; ++k)
    for (int c = 0; c < kSize; ++c) sum[c] += from[k] * d[k * kSize + c];
  std::copy(sum, sum + kSize, to);
}

void Apply(const double* from, const double* d, int size, double* to) {
  if (size == 3) return ApplyOf<3>(from, d, to);
  if (size == 6) return ApplyOf<6>(from, d, to);
  std::fill(to, to + size, 0.0);
  for (int k = 0; k < size; ++k)
    for (int c = 0; c < size; ++c) to[c] += from[k] * d[k * size + c];
}

void* Create(const graticule_measurement* measurement, int32_t, int32_t* residual_count,
             graticule_error* error) {
  const double* values = measurement->values;
  const double rows = values[0], columns = values[1];
  constexpr double kMost = 100000;
  if (!(rows >= 1 && rows <= kMost && columns >= 1 && columns <= kMost) ||
      rows != std::floor(rows) || columns != std::floor(columns)) {
    Say(error, "expected the numbers of rows and columns, each 1 to 100000, as its first two");
    return nullptr;
  }
  const double matrix = rows * columns, others = measurement->value_count - 2 - matrix - rows;
  if (others < 1) {
    Say(error, "fewer numbers than its rows and columns need");
    return nullptr;
  }
  auto gaussian = std::make_unique<Gaussian>();
  gaussian->rows = static_cast<int>(rows);
  gaussian->columns = static_cast<int>(columns);
  const double* next = values + 2;
  for (const auto& [to, count] :
       {std::pair(&gaussian->point, others), {&gaussian->r, matrix}, {&gaussian->b, rows}}) {
    to->assign(next, next + static_cast<std::ptrdiff_t>(count));
    next += static_cast<std::ptrdiff_t>(count);
  }
  *residual_count = gaussian->rows;
  return gaussian.release();
}

int32_t Evaluate(const void*, const double* const*, double*, double**, graticule_error* error) {
  Say(error, "only the solver evaluates it");
  return 0;
}

void Destroy(void* self) { delete static_cast<Gaussian*>(self); }

constexpr graticule_factor_type_v1 kTable = {
    sizeof(graticule_factor_type_v1),
    GRATICULE_FACTOR_TANGENT_JACOBIANS,
    kGaussian,
    "x:any/1* | rows columns value* | r*",
    "what variables that were marginalised said about these: R (x [-] x0) - b",
    Create,
    Evaluate,
    Destroy};

}  // namespace

FactorType GaussianType() { return MakeFactorType(kTable, "built-in"); }

bool IsGaussian(const graticule_factor_type_v1* table) { return table == &kTable; }

std::vector<double> Gaussian::Measurement() const {
  std::vector<double> all = {static_cast<double>(rows), static_cast<double>(columns)};
  for (const std::vector<double>* part : {&point, &r, &b})
    all.insert(all.end(), part->begin(), part->end());
  return all;
}

std::string Gaussian::Misfit(const Graph& graph, Span<const VariableId> variables) const {
  std::size_t stored = 0, tangent = 0;
  for (const VariableId id : variables) {
    stored += static_cast<std::size_t>(graph.TypeOf(id).Size());
    tangent += static_cast<std::size_t>(graph.TypeOf(id).TangentSize());
  }
  if (stored == point.size() && tangent == static_cast<std::size_t>(columns)) return "";
  return "it has " + std::to_string(columns) + " columns and a point of " +
         std::to_string(point.size()) + " numbers, its variables need " + std::to_string(tangent) +
         " and " + std::to_string(stored);
}

void Gaussian::Evaluate(const Graph& graph, Span<const VariableId> variables,
                        const double* const* blocks, double* residual, double* const* jacobians,
                        const int* strides) const {
  for (int row = 0; row < rows; ++row) residual[row] = -b[static_cast<std::size_t>(row)];
  // R is triangular, or nearly so, where marginalising made it: half of it need not be looked at.
  std::vector<int> begin(static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    int& column = begin[static_cast<std::size_t>(row)];
    while (column < columns && r[static_cast<std::size_t>(row * columns + column)] == 0) ++column;
  }
  std::vector<double> step, along;
  const double* x0 = point.data();
  int first = 0;  // of the variable's columns
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const VariableType& type = graph.TypeOf(variables[i]);
    const int size = type.TangentSize();
    step.resize(static_cast<std::size_t>(size));
    along.resize(static_cast<std::size_t>(size * size));
    type.Minus(blocks[i], x0, step.data());
    const bool has_jacobian = jacobians && jacobians[i];
    if (has_jacobian) type.MinusJacobian(blocks[i], x0, along.data());
    for (int row = 0; row < rows; ++row) {
      double* to = has_jacobian ? jacobians[i] + row * strides[i] : nullptr;
      if (begin[static_cast<std::size_t>(row)] >= first + size) {
        if (has_jacobian) std::fill(to, to + size, 0.0);
        continue;
      }
      const double* from = r.data() + row * columns + first;
      for (int k = 0; k < size; ++k) residual[row] += from[k] * step[static_cast<std::size_t>(k)];
      if (has_jacobian) Apply(from, along.data(), size, to);
    }
    x0 += type.Size();
    first += size;
  }
}

}  // namespace graticule
