#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/io/camera_file.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/calibration/target.hpp"

namespace graticule {

/// The camera of a robot: all are of one make (121 degrees, after a lens of the thesis'
/// Figure 5.8), and no two alike.
CameraIntrinsics TownCamera(std::size_t robot, std::uint64_t seed);

/// A picture that a robot's camera took of the target.
struct TargetPicture {
  GreyImage image;
  Se3Array camera_from_target;  ///< the truth
};

/// Pictures as somebody takes them who follows the usual rules: left, right, near, far, tilted.
/// Same arguments, same digits; picture k does not depend on how many there are.
std::vector<TargetPicture> TakePictures(const CameraIntrinsics& camera, const Target& target,
                                        std::size_t count, std::uint64_t seed);

}  // namespace graticule
