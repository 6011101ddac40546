#include "graticule/factors/camera_model.hpp"

#include <deque>
#include <mutex>
#include <shared_mutex>

#include "graticule/factors/registration.hpp"
#include "graticule/factors/reprojection.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {
namespace {

template <class Lens>
CameraModel Model() {
  return {Lens::kName,
          Lens::kFields,
          4 + Lens::kTerms,
          lens::Start<Lens>::kTerms,
          ProjectThrough<Lens>,
          lens::SeesBehind<Lens>::value,
          CameraVariable<Lens>::kName,
          Reprojection<Lens>::kName,
          PriorCamera<Lens>::kName,
          CornerReprojection<Lens>::kName,
          PointReprojection<Lens>::kName};
}

template <class... Lenses>
std::vector<CameraModel> Models() {
  return {Model<Lenses>()...};
}

const std::vector<CameraModel>& Builtin() {
  static const std::vector<CameraModel> models =
      Models<PinholeLens, Radial2Lens, Radial3Lens, Brown4Lens, Brown5Lens, Brown8Lens,
             AngularLens<1>, AngularLens<2>, AngularLens<3>, AngularLens<4>, AngularLens<5>,
             AngularLens<6>, UnifiedLens, ExtendedUnifiedLens, DoubleSphereLens>();
  return models;
}

// Of plug-ins.  A camera is a value that knows its model by name, and loaded libraries are the
// process' own: so are their lenses.  Nothing is ever taken out, and a deque does not move what it
// holds.
struct Added {
  std::shared_mutex mutex;
  std::deque<CameraModel> models;
};

Added& AddedModels() {
  static Added added;
  return added;
}

const CameraModel* Find(std::string_view name, const Added& added) {
  for (const CameraModel& model : Builtin())
    if (name == model.name) return &model;
  for (const CameraModel& model : added.models)
    if (name == model.name) return &model;
  return nullptr;
}

}  // namespace

Span<const CameraModel> CameraModels() { return {Builtin().data(), Builtin().size()}; }

const CameraModel& CameraModelOf(std::string_view name) {
  for (const CameraModel& model : Builtin())
    if (name == model.name) return model;
  Added& added = AddedModels();
  const std::shared_lock<std::shared_mutex> lock(added.mutex);
  if (const CameraModel* model = Find(name, added)) return *model;
  std::vector<std::string_view> names;
  for (const CameraModel& model : Builtin()) names.emplace_back(model.name);
  for (const CameraModel& model : added.models) names.emplace_back(model.name);
  std::string message =
      "no camera model '" + std::string(name) + "'" + DidYouMean(name, names) + "; there are";
  for (const std::string_view known : names) message += " " + std::string(known);
  throw Error(message, ErrorKind::kUsage);
}

void AddCameraModels(const std::vector<CameraModel>& models) {
  Added& added = AddedModels();
  const std::unique_lock<std::shared_mutex> lock(added.mutex);
  std::vector<const CameraModel*> fresh;
  for (const CameraModel& model : models) {
    const CameraModel* known = Find(model.name, added);
    if (!known)
      fresh.push_back(&model);
    else if (known->project != model.project)
      throw Error(std::string("camera model ") + model.name + " is already taken",
                  ErrorKind::kUsage);
  }
  for (const CameraModel* model : fresh) added.models.push_back(*model);
}

}  // namespace graticule
