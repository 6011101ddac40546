#include "graticule/factors/lens_plugin.hpp"

#include <dlfcn.h>

#include <filesystem>

#include "graticule/factors/camera_model.hpp"
#include "graticule/factors/lens_abi.h"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

[[noreturn]] void Refuse(const std::string& file, const std::string& why) {
  throw Error("plug-in " + file + " refused: " + why, ErrorKind::kMissingType);
}

// Its variable and factors, as reprojection.hpp names them.
void CheckTypes(const std::string& file, const CameraModel& model, const Registry& types) {
  const std::string name = model.name;
  const auto variable = types.FindVariableType(model.variable);
  if (!variable) Refuse(file, "lens " + name + " needs variable type " + model.variable);
  if (variable->Size() != model.parameters)
    Refuse(file, "lens " + name + " has " + std::to_string(model.parameters) + " parameters, " +
                     model.variable + " " + std::to_string(variable->Size()));
  for (const std::string& factor :
       {model.view_factor, model.prior_factor, model.corner_factor, model.point_factor})
    if (!types.FindFactorType(factor))
      Refuse(file, "lens " + name + " needs factor type " + factor);
}

CameraModel ModelOf(const std::string& file, const graticule_lens_v1* lens) {
  if (!lens || lens->size < sizeof(graticule_lens_v1))
    Refuse(file, "the table of one of its lenses is null or too short");
  if (!lens->name || !*lens->name || !lens->fields || !lens->project || lens->parameters < 4 ||
      lens->parameters > 1000)
    Refuse(file, "a lens has no name, no fields, no function, or fewer than four parameters");
  const std::string name = lens->name;
  CameraModel model;
  model.name = lens->name;
  model.fields = lens->fields;
  model.parameters = lens->parameters;
  model.start = lens->start;
  model.project = lens->project;
  model.sees_behind = (lens->flags & GRATICULE_LENS_SEES_BEHIND) != 0;
  model.variable = "camera_" + name + "/1";
  model.view_factor = "reprojection_" + name + "/1";
  model.prior_factor = "prior_camera_" + name + "/1";
  model.corner_factor = "corner_reprojection_" + name + "/1";
  model.point_factor = "point_reprojection_" + name + "/1";
  return model;
}

}  // namespace

std::vector<std::string> LoadLenses(const std::string& file, const Registry& types) {
  const std::string path = std::filesystem::absolute(file).string();
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) Refuse(file, "it could not be opened");
  const auto entry =
      reinterpret_cast<graticule_lenses_entry>(dlsym(library, GRATICULE_LENSES_ENTRY));
  if (!entry) return {};
  const graticule_lenses_v1* table = entry();
  if (!table || table->size < sizeof(graticule_lenses_v1) || table->lens_count < 0 ||
      table->lens_count > 1000 || (table->lens_count > 0 && !table->lenses))
    Refuse(file, "its table of lenses is not right");
  std::vector<CameraModel> models;
  std::vector<std::string> names;
  for (int32_t i = 0; i < table->lens_count; ++i) {
    models.push_back(ModelOf(file, table->lenses[i]));
    CheckTypes(file, models.back(), types);
    names.emplace_back(models.back().name);
  }
  try {
    AddCameraModels(models);
  } catch (const Error& error) {
    Refuse(file, error.what());
  }
  return names;
}

}  // namespace graticule
