#pragma once

#include <string_view>
#include <vector>

#include "graticule/solver/span.hpp"

namespace graticule {

/// A camera model that is known by name while running: "angular4".  The models are lens.hpp's.
struct CameraModel {
  const char* name;
  const char* fields;  ///< "fx:px fy:px cx:px cy:px k1 k2": its parameters, in order
  int parameters;      ///< how many
  /// Pixel of a point in the camera's frame (x right, y down, z forward), with derivatives
  /// row-major, 2 x 3 and 2 x parameters, or null.  False where the model has no image of it.
  bool (*project)(const double* parameters, const double* point_in_camera, double* pixel,
                  double* by_point, double* by_parameters);
  bool sees_behind;           ///< has images of points with z <= 0
  const char* variable;       ///< "camera_angular4/1"
  const char* view_factor;    ///< "reprojection_angular4/1"
  const char* prior_factor;   ///< "prior_camera_angular4/1"
  const char* corner_factor;  ///< "corner_reprojection_angular4/1"
};

/// All built-in models, the simplest of a family first.
Span<const CameraModel> CameraModels();

/// Throws Error (kUsage) that lists the models, with the nearest name.
const CameraModel& CameraModelOf(std::string_view name);

}  // namespace graticule
