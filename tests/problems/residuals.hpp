#pragma once

#include <stdexcept>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule::testing {

/// The raw residual of a factor, through its C table.
inline std::vector<double> Residual(const Graph& graph, const Values& values, FactorId id) {
  const FactorView factor = graph.FactorAt(id);
  const graticule_measurement m = {sizeof(graticule_measurement),
                                   static_cast<std::int32_t>(factor.measurement.size()),
                                   factor.measurement.data()};
  std::int32_t size = 0;
  graticule_error error{};
  const auto blocks = static_cast<std::int32_t>(factor.variables.size());
  void* made = factor.type->table->create(&m, blocks, &size, &error);
  if (!made) throw std::runtime_error(error.message);
  std::vector<double> residual(static_cast<std::size_t>(size));
  std::vector<const double*> x;
  for (const VariableId variable : factor.variables) x.push_back(values[variable].data());
  const bool done =
      factor.type->table->evaluate(made, x.data(), residual.data(), nullptr, &error) != 0;
  factor.type->table->destroy(made);
  if (!done) throw std::runtime_error(error.message);
  return residual;
}

/// The same divided by its standard deviations.
inline std::vector<double> Whitened(const Graph& graph, const Values& values, FactorId id) {
  std::vector<double> residual = Residual(graph, values, id);
  const Span<const double> sigmas = graph.FactorAt(id).noise.values;
  for (std::size_t i = 0; i < residual.size(); ++i)
    residual[i] /= sigmas[sigmas.size() == 1 ? 0 : i];
  return residual;
}

}  // namespace graticule::testing
