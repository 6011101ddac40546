#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "graticule/problems/calibration/camera.hpp"

namespace graticule {

/// What is taken out of the difference between two models of a camera before it counts as error.
///
/// A camera's frame is where its model says: two models that differ by a turn of the frame, and
/// nothing else, agree on everything that can be measured with the camera.  mrcal calls the turn
/// the implied transformation (mrcal.secretsauce.net, "how to compute the implied transformation").
enum class EreGauge {
  kRaw,                  ///< nothing: the frame is that of the model, as in Algorithm 5.1
  kRotationCompensated,  ///< the rotation that brings the images nearest (least squares)
  kMotionCompensated,    ///< rotation and translation: for points at a finite range
};

/// "raw", "rotation_compensated", "motion_compensated".
const char* NameOf(EreGauge gauge);
/// Throws Error (kUsage) that lists the names.
EreGauge EreGaugeOf(std::string_view name);

/// A pixel, its ray, and what moves its image: the model's parameters, and the point's motion.
struct MovingPixel {
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray = Eigen::Vector3d::Zero();  ///< of length 1; zero: no ray has its image here
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_parameters;
  /// By a rotation of the point about the camera [rad], and by a translation [ranges].
  Eigen::Matrix<double, 2, 6> by_motion = Eigen::Matrix<double, 2, 6>::Zero();

  bool HasRay() const { return ray.z() != 0 || ray.x() != 0; }
};

MovingPixel MovingPixelAt(const Camera& camera, const Eigen::Vector2d& pixel);

/// A grid of pixels over the image, row by row; the outermost are the image's very corners.
std::vector<MovingPixel> MovingPixels(const Camera& camera, int columns, int rows);

/// The motion that undoes best, over these pixels, what a change of the parameters does to them:
/// motion = -G change.  Rows of G: rotation [rad], then translation [ranges]; those that the gauge
/// does not ask for are zero.  Pixels without rays do not count.
Eigen::MatrixXd ImpliedMotion(const std::vector<MovingPixel>& pixels, EreGauge gauge);

}  // namespace graticule
