#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// A camera's intrinsic parameters, as its files have them.
struct CameraIntrinsics {
  std::string name;                ///< "cam0", "" where a file has none
  std::string model;               ///< "angular4": factors/camera_model.hpp
  int width = 0, height = 0;       ///< px
  std::vector<double> parameters;  ///< fx fy cx cy [px], then the model's terms
};

/// A camera of a rig.
struct RigCamera {
  CameraIntrinsics intrinsics;
  /// x y z [m] qx qy qz qw
  std::array<double, 7> camera_from_rig = {0, 0, 0, 0, 0, 0, 1};
  /// Of the parameters, row by row; empty where it is not known.
  std::vector<double> covariance;
};

/// One camera, or several that are fixed to each other.
struct CameraRig {
  std::vector<RigCamera> cameras;
  /// What else is said: how it was calibrated, with what error.  Our own format keeps it.
  std::map<std::string, std::string> meta;
};

enum class CameraFormat {
  kGraticule,  ///< YAML of our own: every model, covariances, rigs, meta
  kOpenCv,     ///< FileStorage YAML; one camera, or two with R and T (XML is read, too)
  kRos,        ///< camera_info YAML; one camera
  kKalibr,     ///< camchain YAML; one camera or several
  kMrcal,      ///< .cameramodel; one camera
};

/// "graticule", "opencv", "ros", "kalibr", "mrcal".
std::string_view ToString(CameraFormat format);
/// Throws Error (kUsage) that lists them.
CameraFormat CameraFormatFromWord(std::string_view word);

/// Reads any of these formats, told apart by what is in the file.  The size of the images is 0
/// where a file does not say it (OpenCV's stereo_calib).
///
/// - OpenCV: `distortion_coefficients` of 4, 5, 8 terms are brown4, brown5, brown8, or with
///   `fisheye_model: 1` angular4; with `xi` it is the omnidirectional model: unified.
/// - ROS: plumb_bob, rational_polynomial, equidistant.
/// - Kalibr: pinhole-radtan, pinhole-equi, pinhole-none, omni-none, eucm-none, ds-none.
/// - mrcal: LENSMODEL_PINHOLE, OPENCV4, OPENCV5, OPENCV8.
///
/// Throws Error "file:line:column: ..." : another model (by name), terms that are not zero and that
/// no model of ours has, numbers that are missing or not finite, an unknown file.
CameraRig ReadCameras(const std::string& path);
CameraRig ParseCameras(std::string_view text, const std::string& name);

/// A file's only camera; throws Error where there are several.
CameraIntrinsics ReadCamera(const std::string& path);

/// The format that a name's ending means: `.cameramodel` is mrcal's, all others are ours.
CameraFormat CameraFormatOf(const std::string& path);

/// A camera is written as the smallest model of the format that contains it exactly: radial3 as
/// five coefficients, angular3 as four, a pinhole as zeros.
///
/// Throws Error (kUsage) where the format cannot say it, with the formats that can.  Without
/// covariances and meta, but for our own; all numbers come back to the last bit, but for places
/// of cameras (rounding), and the unified model in OpenCV's and Kalibr's terms (rounding).
std::string FormatCameras(const CameraRig& rig, CameraFormat format);
void WriteCameras(const std::string& path, const CameraRig& rig,
                  std::optional<CameraFormat> format = std::nullopt);
void WriteCamera(const std::string& path, const CameraIntrinsics& camera,
                 std::optional<CameraFormat> format = std::nullopt);

}  // namespace graticule
