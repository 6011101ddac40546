#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/io/correspondences.hpp"
#include "graticule/problems/mapping/simulate.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"

namespace graticule {

/// The street as a robot's swept LIDAR and its camera see it at one place of its way.
struct TownScene {
  PlanarPose world_from_robot;  ///< where it stood: below the LIDAR, which is 1 m above the ground
  /// Labels: 1 ground, 2 to 19 faces of walls, from 20 on things (trees, cars, furniture).
  SimulatedScene scene;
  /// Points of the scan where a person found them in the image: to about a pixel on either axis,
  /// but for `wrong` of them, which are 20 to 60 px off.
  std::vector<Correspondence> points;
  std::vector<std::size_t> wrong;
};

/// How what stands on the cells of a town is seen in three dimensions, from where the robot sees
/// the most trees and cars within 3 to 12 m.  Same arguments, same digits.  Throws Error (kUsage):
/// the mission has no scan of that robot.
TownScene SimulateTownScene(const SimulatedMission& mission, std::size_t robot,
                            const CameraIntrinsics& camera, std::uint64_t seed);

}  // namespace graticule
