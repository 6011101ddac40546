#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/camera.hpp"
#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/calibration/target.hpp"
#include "graticule/problems/random.hpp"

namespace graticule {

struct RenderOptions {
  double blur_px = 0.5;  ///< standard deviation of the lens' blur
  double noise = 2;      ///< standard deviation of a pixel's shade, of 255
  int rays = 2;          ///< along a side of a pixel
  double black = 30, white = 220;
  /// A room of brick walls behind the target, whose straight lines a lens bends; else plain.
  bool has_room = true;
};

/// Pictures of a flat target, as a camera takes them: every pixel's rays meet the target's plane,
/// and the print is looked up there.  Any model that unprojects; black where no ray has its image.
/// Rays are found once, at every other pixel, and are linear between (below 0.002 px in the study's
/// lenses); a picture of 640 x 480 pixels then takes some milliseconds.
class TargetRenderer {
 public:
  /// Throws Error (kUsage): CheckTarget, no rays.
  TargetRenderer(const Target& target, const Camera& camera, const RenderOptions& options = {});

  /// The target at a pose, or the room alone.  The noise is drawn from `random`.
  GreyImage Render(const std::optional<Se3Array>& camera_from_target, RandomNumbers* random) const;

 private:
  /// The print, its texels averaged by fours from level to level.
  struct Level {
    int width = 0, height = 0;
    std::vector<std::uint8_t> shades;
  };

  void Print(const Target& target);
  void FindRays();
  void PaintRoom();
  void DrawTarget(const Eigen::Isometry3d& camera_from_target, std::vector<float>* shades) const;
  const Level& LevelAt(const Eigen::Isometry3d& camera_from_target, double* texel_m) const;

  Camera camera_;
  RenderOptions options_;
  bool printed_towards_z_ = false;
  std::array<double, 4> extent_ = {};  ///< x0 y0 x1 y1 [m]
  double texel_m_ = 0;                 ///< of the finest level
  std::vector<Level> levels_;
  std::vector<std::array<float, 3>> rays_;  ///< of a pixel one after another; zero: none
  std::vector<float> room_;
};

}  // namespace graticule
