#include "graticule/factors/builtins.hpp"

#include "graticule/factors/camera.hpp"
#include "graticule/factors/landmark.hpp"
#include "graticule/factors/pose.hpp"
#include "graticule/factors/position.hpp"
#include "graticule/factors/prior.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {
namespace {

constexpr const char* kOrigin = "built-in";

template <class... Factors>
void AddFactors(Registry* registry) {
  (registry->Add(MakeFactorType(sdk::Table<Factors>::kTable, kOrigin)), ...);
}

}  // namespace

Registry Builtins() {
  Registry registry;
  for (const graticule_variable_type_v1* table : BuiltinVariableTables())
    registry.Add(MakeVariableType(*table, kOrigin));
  AddFactors<BetweenSe2, BetweenSe3, BetweenSe3Quaternion>(&registry);
  AddFactors<LandmarkSe2, LandmarkSe3, LandmarkOffsetSe3>(&registry);
  AddFactors<BearingSe2, RangeSe2, BearingRangeSe2>(&registry);
  AddFactors<PriorSe2, PriorSe3, PriorSe3Quaternion>(&registry);
  AddFactors<PriorOffsetSe3, PriorOffsetSe3Quaternion>(&registry);
  AddFactors<PriorPoint2, PriorPoint3>(&registry);
  AddFactors<PositionSe2, PositionSe3>(&registry);
  AddFactors<BalReprojection>(&registry);
  return registry;
}

}  // namespace graticule
