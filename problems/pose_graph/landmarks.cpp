#include "graticule/problems/pose_graph/landmarks.hpp"

#include <cstdint>
#include <map>

#include "graticule/problems/pose_graph/sighting.hpp"

namespace graticule {

PlacedLandmarks PlaceLandmarks(const Graph& graph, Values* values) {
  std::vector<Sight> sights;
  for (const FactorType& type : graph.UsedFactorTypes()) sights.push_back(SightOf(type.name));

  PlacedLandmarks count;
  std::vector<std::uint8_t> placed(graph.VariableCount());
  std::map<VariableId, PartialSightings> partial;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const Sight sight = sights[graph.FactorTypeIndex(id)];
    if (sight == Sight::kNone) continue;
    const FactorView factor = graph.FactorAt(id);
    const VariableId landmark = factor.variables[1];
    if (placed[landmark] || graph.IsFixed(landmark)) continue;
    const double* pose = (*values)[factor.variables[0]].data();
    const double* measured = factor.measurement.data();
    if (!SaysAll(sight)) {
      partial[landmark].Add(sight, pose, measured);
    } else {
      PlaceFromSight(sight, pose, measured, values->Mutable(landmark));
      placed[landmark] = 1;
      ++count.placed;
    }
  }
  for (const auto& [landmark, known] : partial) {
    if (placed[landmark]) continue;
    ++count.placed;
    if (!known.Place(values->Mutable(landmark))) ++count.assumed;
  }
  return count;
}

}  // namespace graticule
