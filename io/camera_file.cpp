#include "graticule/io/camera_file.hpp"

#include <cmath>
#include <filesystem>

#include "graticule/io/camera_formats.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::array<CameraFormat, 5> kFormats = {CameraFormat::kGraticule, CameraFormat::kOpenCv,
                                                  CameraFormat::kRos, CameraFormat::kKalibr,
                                                  CameraFormat::kMrcal};

bool CanSay(CameraFormat format, const CameraIntrinsics& camera) {
  const auto brown = BrownTerms(camera);
  const bool is_angular = AngularTerms(camera).has_value();
  switch (format) {
    case CameraFormat::kGraticule:
      return true;
    case CameraFormat::kOpenCv:
      return brown || is_angular || UnifiedAlpha(camera);
    case CameraFormat::kRos:
      return brown || is_angular;
    case CameraFormat::kKalibr:
      return brown ? BrownCount(*brown) <= 4
                   : is_angular || ExtendedUnifiedTerms(camera) || DoubleSphereTerms(camera);
    case CameraFormat::kMrcal:
      return brown.has_value();
  }
  return false;
}

bool HoldsCameras(CameraFormat format, std::size_t count) {
  if (count == 1 || format == CameraFormat::kGraticule || format == CameraFormat::kKalibr)
    return true;
  return format == CameraFormat::kOpenCv && count == 2;
}

std::string Names(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

template <class Holds>
std::string FormatsThat(const Holds& holds) {
  std::vector<std::string> names;
  for (const CameraFormat format : kFormats)
    if (holds(format)) names.emplace_back(ToString(format));
  return Names(names) + (names.size() == 1 ? " holds it" : " hold it");
}

void CheckToWrite(const CameraRig& rig, CameraFormat format) {
  const auto refuse = [](const std::string& why) { throw Error(why, ErrorKind::kUsage); };
  if (rig.cameras.empty()) refuse("there is no camera to write");
  if (!HoldsCameras(format, rig.cameras.size()))
    refuse("a rig of " + std::to_string(rig.cameras.size()) + " cameras does not go into one " +
           std::string(ToString(format)) + " file: " + FormatsThat([&](CameraFormat other) {
             return HoldsCameras(other, rig.cameras.size());
           }));
  for (const RigCamera& camera : rig.cameras) {
    const CameraIntrinsics& own = camera.intrinsics;
    const std::size_t n = own.parameters.size();
    bool is_finite = n >= 4;
    for (const double value : own.parameters) is_finite &= std::isfinite(value);
    for (const double value : camera.camera_from_rig) is_finite &= std::isfinite(value);
    for (const double value : camera.covariance) is_finite &= std::isfinite(value);
    if (!is_finite || (!camera.covariance.empty() && camera.covariance.size() != n * n))
      refuse("camera " + Quoted(own.name) +
             ": expected parameters and a covariance of matching size, all finite");
    if (!CanSay(format, own))
      refuse("camera " + Quoted(own.name) + ": the " + std::string(ToString(format)) +
             " format cannot say this " + own.model +
             " model: " + FormatsThat([&](CameraFormat other) { return CanSay(other, own); }));
  }
}

// Where the text begins, without what is passed over in every format.
char FirstSign(std::string_view text) {
  std::size_t at = 0;
  for (;;) {
    at = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF", at);
    if (at == std::string_view::npos) return '\0';
    if (text[at] != '#') return text[at];
    at = text.find('\n', at);
    if (at == std::string_view::npos) return '\0';
  }
}

}  // namespace

std::string_view ToString(CameraFormat format) {
  switch (format) {
    case CameraFormat::kGraticule:
      return "graticule";
    case CameraFormat::kOpenCv:
      return "opencv";
    case CameraFormat::kRos:
      return "ros";
    case CameraFormat::kKalibr:
      return "kalibr";
    case CameraFormat::kMrcal:
      return "mrcal";
  }
  return "";
}

CameraFormat CameraFormatFromWord(std::string_view word) {
  for (const CameraFormat format : kFormats)
    if (ToString(format) == word) return format;
  throw Error("there is no format " + Quoted(word) +
                  " of cameras; expected graticule, opencv, ros, kalibr or mrcal",
              ErrorKind::kUsage);
}

CameraFormat CameraFormatOf(const std::string& path) {
  return std::filesystem::path(WithoutGz(path)).extension() == ".cameramodel"
             ? CameraFormat::kMrcal
             : CameraFormat::kGraticule;
}

CameraRig ParseCameras(std::string_view text, const std::string& name) {
  const char first = FirstSign(text);
  if (first == '\0') throw Error(name + ": the file is empty");
  if (first == '<') {
    const DocumentNode root = ParseXml(text, name);
    return ReadOpenCvCameras(root);
  }
  if (first == '{' && text.find("lensmodel") != std::string_view::npos)
    return ReadMrcalCamera(ParsePythonLiteral(text, name));
  const DocumentNode root = ParseYaml(text, name);
  if (root.Find("graticule-camera")) return ReadOwnCameras(root);
  if (root.Find("cam0")) return ReadKalibrCameras(root);
  if (root.Find("distortion_model")) return ReadRosCamera(root);
  for (const char* key : {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "M", "M1", "K1"})
    if (root.Find(key)) return ReadOpenCvCameras(root);
  throw Error(name +
              ": expected a camera's file: OpenCV's (camera_matrix), ROS' (camera_matrix, "
              "distortion_model), Kalibr's (cam0), mrcal's (lensmodel) or graticule's");
}

CameraRig ReadCameras(const std::string& path) { return ParseCameras(ReadFile(path), path); }

CameraIntrinsics ReadCamera(const std::string& path) {
  CameraRig rig = ReadCameras(path);
  if (rig.cameras.size() != 1)
    throw Error(path + ": expected one camera, found " + std::to_string(rig.cameras.size()));
  return std::move(rig.cameras[0].intrinsics);
}

std::string FormatCameras(const CameraRig& rig, CameraFormat format) {
  CheckToWrite(rig, format);
  switch (format) {
    case CameraFormat::kGraticule:
      return FormatOwnCameras(rig);
    case CameraFormat::kOpenCv:
      return FormatOpenCvCameras(rig);
    case CameraFormat::kRos:
      return FormatRosCamera(rig);
    case CameraFormat::kKalibr:
      return FormatKalibrCameras(rig);
    case CameraFormat::kMrcal:
      return FormatMrcalCamera(rig);
  }
  return "";
}

void WriteCameras(const std::string& path, const CameraRig& rig,
                  std::optional<CameraFormat> format) {
  WriteFile(path, FormatCameras(rig, format.value_or(CameraFormatOf(path))));
}

void WriteCamera(const std::string& path, const CameraIntrinsics& camera,
                 std::optional<CameraFormat> format) {
  CameraRig rig;
  rig.cameras.push_back({camera, kCameraAtRig, {}});
  WriteCameras(path, rig, format);
}

}  // namespace graticule
