#include "graticule/problems/subgraph.hpp"

#include <cmath>

namespace graticule {
FactorCopier::FactorCopier(const Graph& graph) : graph_(graph), variables_(graph.Slice({})) {
  for (const FactorType& type : graph.UsedFactorTypes())
    types_.push_back(variables_.FactorTypeId(type.name));
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    variables_.Add(graph.KeyOf(id), variables_.VariableTypeId(graph.TypeOf(id).name),
                   graph.ValueOf(id), graph.IsFixed(id));
}

void FactorCopier::Copy(FactorId id, double weight, const Loss& loss, Graph* to) {
  const FactorView factor = graph_.FactorAt(id);
  NoiseView noise = factor.noise;
  if (weight != 1) {
    const double sigmas_by = 1 / std::sqrt(weight);
    scaled_.assign(noise.values.begin(), noise.values.end());
    for (double& value : scaled_) value *= noise.kind == NoiseKind::kSigma ? sigmas_by : weight;
    if (noise.kind == NoiseKind::kUnit) {
      noise.kind = NoiseKind::kSigma;
      scaled_.assign(1, sigmas_by);
    }
    noise.values = scaled_;
  }
  to->Add(types_[graph_.FactorTypeIndex(id)], factor.variables, factor.measurement, noise, loss,
          factor.source);
}

Graph KeepFactors(const Graph& graph, const std::vector<bool>& keep) {
  FactorCopier copier(graph);
  Graph kept = copier.Variables();
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    if (keep[id]) copier.Copy(id, 1, graph.FactorAt(id).loss, &kept);
  return kept;
}

}  // namespace graticule
