#pragma once

#include <vector>

#include "graticule/io/image_field.hpp"
#include "graticule/problems/segmentation/coregister.hpp"

namespace graticule {

/// How far a LIDAR's points may be drawn from where the camera sees them, because the extrinsics
/// are known only so well: expected length of the pixel's error (thesis, section 4.5 asks for it;
/// section 5.2.1 has it for intrinsics).
struct ExtrinsicError {
  double range_m = 0;  ///< of the points, from the camera
  ImageField field;    ///< px; NaN where no ray is
  double max_px = 0;
  ImagePoint max_at;
};

/// At each of several ranges [m] over `nodes` pixels along the image's longer side.  The camera's
/// parameters are taken as they are.
std::vector<ExtrinsicError> ExpectedErrors(const Camera& camera, const Se3Array& camera_from_lidar,
                                           const Matrix6& covariance,
                                           const std::vector<double>& ranges_m,
                                           std::size_t nodes = 17);

/// Where one more correspondence would help most.
struct NextCorrespondence {
  ImagePoint pixel;
  double range_m = 0;
  double max_px = 0;  ///< the largest expected error with it, over image and ranges
  double max_px_before = 0;
};

/// Tries every pixel of a grid at every range: what a correspondence there adds to the information
/// is known in closed form, with the options' noise times `solved.scale`.
NextCorrespondence SuggestCorrespondence(const Camera& camera, const Coregistration& solved,
                                         const CoregisterOptions& options,
                                         const std::vector<double>& ranges_m);

}  // namespace graticule
