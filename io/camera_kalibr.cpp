#include <algorithm>
#include <string>

#include "graticule/io/camera_formats.hpp"
#include "graticule/io/json_document.hpp"
#include "graticule/io/text.hpp"

namespace graticule {
namespace {

std::string CamName(std::size_t number) { return "cam" + std::to_string(number); }

CameraIntrinsics ReadIntrinsics(const DocumentNode& node) {
  const DocumentNode& model_node = node.Member("camera_model");
  const DocumentNode& distortion_node = node.Member("distortion_model");
  const std::string& model = model_node.Scalar();
  const std::string& distortion = distortion_node.Scalar();
  const DocumentNode& terms_node = node.Member("distortion_coeffs");
  const std::vector<double> terms = terms_node.Numbers();
  const DocumentNode& intrinsics_node = node.Member("intrinsics");

  CameraIntrinsics camera;
  if (model == "pinhole") {
    camera.parameters = intrinsics_node.Numbers(4);
    if (distortion == "radtan" || distortion == "equi") {
      if (terms.size() != 4) terms_node.FailExpected("a list of 4 numbers");
      camera.model = distortion == "radtan" ? "brown4" : "angular4";
      camera.parameters.insert(camera.parameters.end(), terms.begin(), terms.end());
    } else if (distortion == "none") {
      camera.model = "pinhole";
    } else {
      distortion_node.FailExpected("radtan, equi or none");
    }
  } else if (model == "omni" || model == "eucm" || model == "ds") {
    for (const double value : terms)
      if (value != 0 || distortion == "equi" || distortion == "fov")
        distortion_node.Fail("expected no distortion beside " + model +
                             ": together they are none of our models");
    const std::vector<double> k = intrinsics_node.Numbers(model == "omni" ? 5 : 6);
    if (model == "omni") {
      if (!(k[0] > -1)) intrinsics_node.values[0].FailExpected("xi above -1");
      camera = FromOmni(k[0], k[1], k[2], k[3], k[4]);
    } else {
      camera.model = model == "eucm" ? "extended_unified" : "double_sphere";
      camera.parameters = {k[2], k[3], k[4], k[5], k[0], k[1]};
    }
  } else {
    model_node.FailExpected("pinhole, omni, eucm or ds");
  }
  if (!(camera.parameters[0] > 0 && camera.parameters[1] > 0))
    intrinsics_node.Fail("expected focal lengths above zero");
  const DocumentNode& resolution = node.Member("resolution");
  if (resolution.List().values.size() != 2) resolution.FailExpected("a list of 2 numbers");
  camera.width = static_cast<int>(resolution.values[0].Integer(1, kMostPixelsASide));
  camera.height = static_cast<int>(resolution.values[1].Integer(1, kMostPixelsASide));
  return camera;
}

CameraPose ReadTransform(const DocumentNode& node) {
  if (node.List().values.size() != 4) node.FailExpected("a list of 4 rows");
  std::vector<double> rotation, translation;
  for (std::size_t row = 0; row < 4; ++row) {
    const std::vector<double> values = node.values[row].Numbers(4);
    if (row == 3) {
      if (values != std::vector<double>{0, 0, 0, 1}) node.values[row].FailExpected("0, 0, 0, 1");
      continue;
    }
    rotation.insert(rotation.end(), values.begin(), values.begin() + 3);
    translation.push_back(values[3]);
  }
  if (!IsRotation(rotation.data())) node.Fail("expected a rotation and a translation");
  return PoseOf(rotation.data(), translation.data());
}

std::string FormatIntrinsics(const CameraIntrinsics& camera) {
  const std::vector<double>& p = camera.parameters;
  std::string model = "pinhole", distortion = "none";
  std::vector<double> terms, intrinsics(p.begin(), p.begin() + 4);
  if (camera.model == "pinhole") {
  } else if (const auto brown = BrownTerms(camera)) {
    distortion = "radtan";
    terms.assign(brown->begin(), brown->begin() + 4);
  } else if (const auto angular = AngularTerms(camera)) {
    distortion = "equi";
    terms.assign(angular->begin(), angular->end());
  } else if (camera.model == "unified") {
    const Omni omni = ToOmni(camera, p[4]);
    model = "omni";
    intrinsics = {omni.xi, omni.fx, omni.fy, p[2], p[3]};
  } else {
    model = camera.model == "double_sphere" ? "ds" : "eucm";
    intrinsics = {p[4], p[5], p[0], p[1], p[2], p[3]};
  }
  return "  camera_model: " + model + "\n  distortion_coeffs: " + NumberList(terms) +
         "\n  distortion_model: " + distortion + "\n  intrinsics: " + NumberList(intrinsics) + "\n";
}

}  // namespace

CameraRig ReadKalibrCameras(const DocumentNode& root) {
  CameraRig rig;
  CameraPose camera_from_rig = kCameraAtRig;
  std::size_t last_overlap = 0;
  for (std::size_t i = 0; const DocumentNode* node = root.Find(CamName(i)); ++i) {
    RigCamera camera;
    camera.intrinsics = ReadIntrinsics(*node);
    camera.intrinsics.name = CamName(i);
    if (i > 0) {
      camera_from_rig = Compose(ReadTransform(node->Member("T_cn_cnm1")), camera_from_rig);
      camera.camera_from_rig = camera_from_rig;
    }
    if (const DocumentNode* overlaps = node->Find("cam_overlaps"))
      for (const DocumentNode& other : overlaps->List().values)
        last_overlap = std::max(last_overlap, static_cast<std::size_t>(other.Integer(0, 10000)));
    rig.cameras.push_back(std::move(camera));
  }
  if (last_overlap >= rig.cameras.size())
    root.Fail("expected " + CamName(rig.cameras.size()) + ": the cameras before overlap with " +
              CamName(last_overlap));
  return rig;
}

std::string FormatKalibrCameras(const CameraRig& rig) {
  std::string text;
  const std::size_t count = rig.cameras.size();
  for (std::size_t i = 0; i < count; ++i) {
    const CameraIntrinsics& camera = rig.cameras[i].intrinsics;
    text += CamName(i) + ":\n";
    if (i > 0) {
      const CameraPose from_last =
          Compose(rig.cameras[i].camera_from_rig, Inverse(rig.cameras[i - 1].camera_from_rig));
      const std::array<double, 9> r = RotationMatrixOf(from_last);
      text += "  T_cn_cnm1:\n";
      for (std::size_t row = 0; row < 3; ++row) {
        const double values[4] = {r[3 * row], r[3 * row + 1], r[3 * row + 2], from_last[row]};
        text += "  - " + NumberList(values, 4) + "\n";
      }
      text += "  - [0, 0, 0, 1]\n";
    }
    // Whoever reads a chain that was cut short misses a camera.
    std::string others;
    for (std::size_t k = 0; k < count; ++k)
      if (k != i) others += (others.empty() ? "" : ", ") + std::to_string(k);
    if (count > 1) text += "  cam_overlaps: [" + others + "]\n";
    text += FormatIntrinsics(camera);
    text += "  resolution: [" + std::to_string(camera.width) + ", " +
            std::to_string(camera.height) + "]\n";
  }
  return text;
}

}  // namespace graticule
