#pragma once

#include "graticule/problems/segmentation/colour_cloud.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"

namespace graticule {

/// The hallway, coloured; points that the picture does not show stay, without a colour.
inline PointCloud Hallway(std::size_t scans, std::size_t bearings) {
  SceneOptions options;
  options.scans = scans;
  options.bearings = bearings;
  options.bearing_step_rad = 720 * 0.00436332 / static_cast<double>(bearings);
  const SimulatedScene scene = SimulateScene("hallway", options);
  return Coloured(
      scene.cloud,
      ColoursOf(scene.cloud, scene.image, Camera(scene.camera), scene.camera_from_lidar), true);
}

}  // namespace graticule
