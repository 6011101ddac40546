#include "graticule/io/rig.hpp"

#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr const char* kFrame = "rig_frame";
constexpr const char* kCovariance = "camera_from_lidar_covariance";

}  // namespace

LidarRig ParseRig(std::string_view text, const std::string& name) {
  const CameraRig file = ParseCameras(text, name);
  if (file.cameras.size() != 1)
    throw Error(name + ": expected a rig of one camera and a LIDAR, found " +
                std::to_string(file.cameras.size()) + " cameras");
  const auto frame = file.meta.find(kFrame);
  if (frame == file.meta.end() || frame->second != "lidar")
    throw Error(name +
                ": this camera file does not say where a LIDAR is (meta rig_frame: lidar); "
                "`graticule coregister` writes one that does");
  LidarRig rig;
  rig.camera = file.cameras[0].intrinsics;
  rig.camera_from_lidar = file.cameras[0].camera_from_rig;
  rig.meta = file.meta;
  rig.meta.erase(kFrame);
  const auto covariance = rig.meta.find(kCovariance);
  if (covariance == rig.meta.end()) return rig;
  const std::string where = name + ": " + kCovariance;
  TextReader reader(covariance->second, where);
  while (reader.NextWord()) rig.covariance.push_back(reader.Double("an entry of the covariance"));
  if (rig.covariance.size() != 36)
    throw Error(where + ": expected 36 numbers, found " + std::to_string(rig.covariance.size()));
  rig.meta.erase(covariance);
  return rig;
}

LidarRig ReadRig(const std::string& path) {
  return HasEnding(WithoutGz(path), ".txt") ? ParseKittiRig(ReadFile(path), path)
                                            : ParseRig(ReadFile(path), path);
}

std::string FormatRig(const LidarRig& rig) {
  CameraRig file;
  file.meta = rig.meta;
  file.meta[kFrame] = "lidar";
  if (!rig.covariance.empty()) {
    std::string& numbers = file.meta[kCovariance];
    for (const double number : rig.covariance) {
      if (!numbers.empty()) numbers += ' ';
      AppendNumber(&numbers, number);
    }
  }
  file.cameras.push_back({rig.camera, rig.camera_from_lidar, {}});
  return FormatCameras(file, CameraFormat::kGraticule);
}

void WriteRig(const std::string& path, const LidarRig& rig) { WriteFile(path, FormatRig(rig)); }

}  // namespace graticule
