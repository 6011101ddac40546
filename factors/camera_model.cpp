#include "graticule/factors/camera_model.hpp"

#include <string>

#include "graticule/factors/reprojection.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {
namespace {

template <class Lens>
constexpr CameraModel Model(bool sees_behind) {
  return {Lens::kName,
          Lens::kFields,
          4 + Lens::kTerms,
          ProjectThrough<Lens>,
          sees_behind,
          CameraVariable<Lens>::kName,
          Reprojection<Lens>::kName,
          PriorCamera<Lens>::kName,
          CornerReprojection<Lens>::kName};
}

constexpr CameraModel kModels[] = {
    Model<PinholeLens>(false),   Model<Radial2Lens>(false),        Model<Radial3Lens>(false),
    Model<Brown4Lens>(false),    Model<Brown5Lens>(false),         Model<Brown8Lens>(false),
    Model<AngularLens<1>>(true), Model<AngularLens<2>>(true),      Model<AngularLens<3>>(true),
    Model<AngularLens<4>>(true), Model<AngularLens<5>>(true),      Model<AngularLens<6>>(true),
    Model<UnifiedLens>(true),    Model<ExtendedUnifiedLens>(true), Model<DoubleSphereLens>(true),
};

}  // namespace

Span<const CameraModel> CameraModels() { return {kModels, sizeof(kModels) / sizeof(kModels[0])}; }

const CameraModel& CameraModelOf(std::string_view name) {
  std::vector<std::string_view> names;
  for (const CameraModel& model : CameraModels()) {
    if (name == model.name) return model;
    names.emplace_back(model.name);
  }
  std::string message =
      "no camera model '" + std::string(name) + "'" + DidYouMean(name, names) + "; there are";
  for (const std::string_view known : names) message += " " + std::string(known);
  throw Error(message, ErrorKind::kUsage);
}

}  // namespace graticule
