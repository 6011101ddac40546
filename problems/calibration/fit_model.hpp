#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "graticule/problems/calibration/camera.hpp"
#include "graticule/solver/registry.hpp"

namespace graticule {

/// What a model's parameters are where nothing is known but its first four: no distortion, or for
/// lenses that have none as their own, what is like a fisheye.
std::vector<double> PlainParameters(const CameraModel& model, double focal_px, double centre_x,
                                    double centre_y);

/// A camera in the terms of another model, and how far its images are off.
struct FittedModel {
  CameraIntrinsics camera;
  double rms_px = 0;       ///< over the rays that count
  std::size_t unseen = 0;  ///< pixels whose rays the model cannot see
};

/// The camera of another model that sends these pixels' rays to the same pixels as nearly as it can
/// (least squares).  A problem of one factor, solved from PlainParameters.
FittedModel FitModel(const Registry& types, const Camera& camera,
                     const std::vector<Eigen::Vector2d>& pixels, const std::string& model);

}  // namespace graticule
