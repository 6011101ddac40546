#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graticule/solver/span.hpp"

namespace graticule {

/// A camera model that is known by name while running: "angular4".  The built-in models are
/// lens.hpp's.
struct CameraModel {
  const char* name = "";
  const char* fields = "";  ///< "fx:px fy:px cx:px cy:px k1 k2": its parameters, in order
  int parameters = 0;       ///< how many
  /// The terms behind the first four that a fit begins from; null: zeros.
  const double* start = nullptr;
  /// Pixel of a point in the camera's frame (x right, y down, z forward), with derivatives
  /// row-major, 2 x 3 and 2 x parameters, or null.  False where the model has no image of it.
  bool (*project)(const double* parameters, const double* point_in_camera, double* pixel,
                  double* by_point, double* by_parameters) = nullptr;
  bool sees_behind = false;   ///< has images of points with z <= 0
  std::string variable;       ///< "camera_angular4/1"
  std::string view_factor;    ///< "reprojection_angular4/1"
  std::string prior_factor;   ///< "prior_camera_angular4/1"
  std::string corner_factor;  ///< "corner_reprojection_angular4/1"
  std::string point_factor;   ///< "point_reprojection_angular4/1"
};

/// All built-in models, the simplest of a family first.
Span<const CameraModel> CameraModels();

/// A built-in model, or one that was added.  Throws Error (kUsage) that lists the models, with the
/// nearest name.  The answer stays valid.
const CameraModel& CameraModelOf(std::string_view name);

/// Makes further models known in the whole process, for ever: all of them, or none.  What is
/// already known by this name and with this `project` is passed over.  Throws Error (kUsage): a
/// name is taken.  Plug-ins' lenses come this way (lens_plugin.hpp).
void AddCameraModels(const std::vector<CameraModel>& models);

}  // namespace graticule
