#pragma once

// Internal to the simulation of scenes.

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>

#include "graticule/problems/segmentation/simulate_scene.hpp"

namespace graticule {

struct SceneRay {
  Eigen::Vector3d origin, direction;  ///< direction of length 1
};

/// What a ray meets first.
struct SceneHit {
  double distance_m = 0;
  std::uint32_t label = 0;
  Eigen::Vector3d colour;  ///< red green blue, 0 to 255, as it is lit there
};

/// A world that rays are cast into; none where a ray meets nothing.
using RayCaster = std::function<std::optional<SceneHit>(const SceneRay&)>;

/// A LIDAR's sweep with labels: rows from above the horizon down to the feet, the first column on
/// the left.
PointCloud SweepScene(const RayCaster& cast, const Eigen::Isometry3d& world_from_lidar,
                      const SceneOptions& options);

/// A picture; sky and what is too far are white.
ColourImage PhotographScene(const RayCaster& cast, const Camera& camera,
                            const Eigen::Isometry3d& world_from_camera,
                            const SceneOptions& options);

}  // namespace graticule
