#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/camera_file.hpp"

namespace graticule {

/// A camera that is fixed to a LIDAR: what `graticule coregister` writes.
struct LidarRig {
  CameraIntrinsics camera;
  std::array<double, 7> camera_from_lidar = {0, 0, 0, 0, 0, 0, 1};  ///< x y z [m] qx qy qz qw
  /// 6 x 6, row by row, of the tangent: translation [m], rotation [rad], in the LIDAR's frame.
  /// Empty: not known.
  std::vector<double> covariance;
  std::map<std::string, std::string> meta;  ///< how it was found, with what error
};

/// A rig is a camera file of our own (io/camera_file.hpp) whose rig's frame is the LIDAR's, which
/// its meta says: `rig_frame: lidar`.  Every program that reads camera files reads it.
///
/// A name that ends in `.txt` is KITTI's calibration: see ParseKittiRig.
///
/// Throws Error as ReadCameras does, and "path: ..." where it is no rig of one camera and a LIDAR.
LidarRig ReadRig(const std::string& path);
LidarRig ParseRig(std::string_view text, const std::string& name);

/// KITTI's P2, R0_rect and Tr_velo_to_cam: a pinhole whose images' size they do not say (0).
/// Throws Error "name:line: ...": a matrix that is missing, short or no rotation.
LidarRig ParseKittiRig(std::string_view text, const std::string& name);

/// All numbers come back to the last bit.
std::string FormatRig(const LidarRig& rig);
void WriteRig(const std::string& path, const LidarRig& rig);

}  // namespace graticule
