#include <algorithm>
#include <cmath>

#include "graticule/io/camera_formats.hpp"
#include "graticule/io/json_document.hpp"
#include "graticule/io/text.hpp"

namespace graticule {
namespace {

constexpr const char* kVersion = "graticule-camera";

// It is written as it is: a plug-in's, too, has a name of these letters.
std::string ReadModel(const DocumentNode& node) {
  const std::string& name = node.Scalar();
  constexpr const char* kLetters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-";
  if (name.empty() || name.find_first_not_of(kLetters) != std::string::npos)
    node.FailExpected("the name of a camera model");
  return name;
}

RigCamera ReadOne(const DocumentNode& node) {
  RigCamera camera;
  CameraIntrinsics& own = camera.intrinsics;
  if (const DocumentNode* name = node.Find("name")) own.name = name->Scalar();
  own.model = ReadModel(node.Member("model"));
  const DocumentNode& size = node.Member("size");
  if (size.List().values.size() != 2) size.FailExpected("a list of 2 numbers");
  own.width = static_cast<int>(size.values[0].Integer(0, kMostPixelsASide));
  own.height = static_cast<int>(size.values[1].Integer(0, kMostPixelsASide));
  const DocumentNode& parameters = node.Member("parameters");
  own.parameters = parameters.Numbers();
  if (own.parameters.size() < 4) parameters.FailExpected("fx fy cx cy and the terms of the model");
  if (const DocumentNode* pose = node.Find("camera_from_rig")) {
    const std::vector<double> values = pose->Numbers(7);
    std::copy(values.begin(), values.end(), camera.camera_from_rig.begin());
    double squared = 0;
    for (std::size_t i = 3; i < 7; ++i) squared += values[i] * values[i];
    if (!(std::abs(squared - 1) < 1e-6)) pose->FailExpected("a unit quaternion");
  }
  if (const DocumentNode* covariance = node.Find("covariance")) {
    if (covariance->List().values.size() != own.parameters.size())
      covariance->FailExpected(std::to_string(own.parameters.size()) + " rows");
    for (const DocumentNode& row : covariance->values) {
      const std::vector<double> values = row.Numbers(own.parameters.size());
      camera.covariance.insert(camera.covariance.end(), values.begin(), values.end());
    }
  }
  return camera;
}

}  // namespace

CameraRig ReadOwnCameras(const DocumentNode& root) {
  root.Member(kVersion).Integer(1, 1);
  CameraRig rig;
  if (const DocumentNode* meta = root.Find("meta"))
    for (std::size_t i = 0; i < meta->Map().keys.size(); ++i)
      rig.meta[meta->keys[i]] = meta->values[i].Scalar();
  const DocumentNode& cameras = root.Member("cameras");
  for (const DocumentNode& camera : cameras.List().values) rig.cameras.push_back(ReadOne(camera));
  if (rig.cameras.empty()) cameras.FailExpected("a list of cameras");
  // Says that nothing was cut off.
  const auto count = static_cast<long>(rig.cameras.size());
  root.Member("end").Integer(count, count);
  return rig;
}

std::string FormatOwnCameras(const CameraRig& rig) {
  std::string text = std::string(kVersion) + ": 1\n";
  if (!rig.meta.empty()) text += "meta:\n";
  for (const auto& [key, value] : rig.meta)
    text += "  " + JsonQuoted(key) + ": " + JsonQuoted(value) + "\n";
  text += "cameras:\n";
  for (const RigCamera& camera : rig.cameras) {
    const CameraIntrinsics& own = camera.intrinsics;
    text += "  - name: " + JsonQuoted(own.name) + "\n    model: " + own.model + "\n    size: [" +
            std::to_string(own.width) + ", " + std::to_string(own.height) +
            "]\n    parameters: " + NumberList(own.parameters) +
            "\n    camera_from_rig: " + NumberList(camera.camera_from_rig) + "\n";
    if (!camera.covariance.empty()) text += "    covariance:\n";
    const std::size_t n = own.parameters.size();
    for (std::size_t row = 0; n * (row + 1) <= camera.covariance.size(); ++row)
      text += "      - " + NumberList(camera.covariance.data() + n * row, n) + "\n";
  }
  return text + "end: " + std::to_string(rig.cameras.size()) + "\n";
}

}  // namespace graticule
