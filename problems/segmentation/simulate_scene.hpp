#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "graticule/io/cloud.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/problems/calibration/camera.hpp"

namespace graticule {

struct SceneOptions {
  std::size_t scans = 210;               ///< of the sweep: rows of the cloud
  std::size_t bearings = 720;            ///< a scan: columns
  double bearing_step_rad = 0.00436332;  ///< 1/4 degree (Hokuyo UTM-30LX, thesis section 4.3)
  double sweep_rad = 1.3;                ///< of the servo, from the first scan to the last
  double range_sigma_m = 0.01, max_range_m = 30;
  double colour_sigma = 4;  ///< of a pixel's channels, of 0 to 255
  std::uint64_t seed = 1;
};

/// A scene with labels that are known, as a swept LIDAR and a camera beside it see it.
struct SimulatedScene {
  PointCloud cloud;  ///< without colours; labels: 1 ground, 2 to 9 other background, 20 on objects
  ColourImage image;
  CameraIntrinsics camera;                       ///< 752 x 480, 111 degrees, as the thesis'
  std::array<double, 7> camera_from_lidar = {};  ///< x y z [m] qx qy qz qw
};

/// "hallway": floor, walls, bins, a box and a ball, some of the colour of what they stand before;
/// "hill": a rough slope in glaring light with barrels and a tree (thesis Figure 4.4a and i, in
/// kind).  Sensor frame: x ahead, y left, z up, 1 m above the ground.  Throws Error (kUsage) for
/// another name.
SimulatedScene SimulateScene(std::string_view name, const SceneOptions& options = {});

}  // namespace graticule
