#include "graticule/factors/builtins.hpp"

#include "graticule/factors/camera.hpp"
#include "graticule/factors/geodetic.hpp"
#include "graticule/factors/landmark.hpp"
#include "graticule/factors/pose.hpp"
#include "graticule/factors/position.hpp"
#include "graticule/factors/prior.hpp"
#include "graticule/factors/registration.hpp"
#include "graticule/factors/reprojection.hpp"
#include "graticule/factors/sdk.hpp"
#include "graticule/factors/signal.hpp"

namespace graticule {
namespace {

constexpr const char* kOrigin = "built-in";

template <class... Factors>
void AddFactors(Registry* registry) {
  (registry->Add(MakeFactorType(sdk::Table<Factors>::kTable, kOrigin)), ...);
}

template <class... Lenses>
void AddCameras(Registry* registry) {
  (registry->Add(MakeVariableType(sdk::VariableTable<CameraVariable<Lenses>>::kTable, kOrigin)),
   ...);
  (AddFactors<Reprojection<Lenses>, CornerReprojection<Lenses>, PriorCamera<Lenses>,
              PointReprojection<Lenses>>(registry),
   ...);
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
  AddFactors<PositionSe2, PositionSe3, GeodeticSe2>(&registry);
  AddFactors<BalReprojection, BoardPlane>(&registry);
  AddFactors<PathLoss, SignalPath, PathLossNotHeard, SignalPathNotHeard>(&registry);
  AddFactors<AttenuationSmooth, AttenuationPrior, RadioBiasPrior, PathLossPrior>(&registry);
  registry.Add(MakeVariableType(sdk::VariableTable<BoardWarp>::kTable, kOrigin));
  AddCameras<PinholeLens, Radial2Lens, Radial3Lens, Brown4Lens, Brown5Lens, Brown8Lens,
             AngularLens<1>, AngularLens<2>, AngularLens<3>, AngularLens<4>, AngularLens<5>,
             AngularLens<6>, UnifiedLens, ExtendedUnifiedLens, DoubleSphereLens>(&registry);
  return registry;
}

}  // namespace graticule
