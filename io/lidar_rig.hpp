#pragma once

#include <array>
#include <string>
#include <string_view>

#include "graticule/io/camera_file.hpp"

namespace graticule {

/// A camera and a LIDAR that are fixed to each other.
struct LidarRig {
  CameraIntrinsics camera;
  /// x y z [m] qx qy qz qw
  std::array<double, 7> camera_from_lidar = {0, 0, 0, 0, 0, 0, 1};
};

/// Reads a camera file (io/camera_file.hpp) of one camera whose rig's frame is the LIDAR's, as
/// `graticule coregister` writes it; or a `.txt` of KITTI's: P2, R0_rect and Tr_velo_to_cam, a
/// pinhole whose images' size it does not say (0).  Throws Error "file:line: ...": a matrix that is
/// missing, short or no rotation; several cameras.
LidarRig ReadLidarRig(const std::string& path);
LidarRig ParseKittiRig(std::string_view text, const std::string& name);

}  // namespace graticule
