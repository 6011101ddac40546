#include "graticule/io/camera_formats.hpp"
#include "graticule/io/json_document.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr const char* kMatrixNames[] = {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "M"};
constexpr const char* kTermsNames[] = {"distortion_coefficients", "distCoeffs",
                                       "Distortion_Coefficients", "dist_coeffs", "D"};

template <std::size_t kCount>
const DocumentNode& FirstOf(const DocumentNode& root, const char* const (&names)[kCount]) {
  for (const char* name : names)
    if (const DocumentNode* found = root.Find(name)) return *found;
  return root.Member(names[0]);
}

bool IsTrue(const DocumentNode* node) {
  return node && node->Scalar() != "0" && node->Scalar() != "false";
}

void ReadSize(const DocumentNode& root, CameraIntrinsics* camera) {
  const auto read = [&](const char* own, const char* other) {
    const DocumentNode* node = root.Find(own);
    if (!node) node = root.Find(other);
    return node ? static_cast<int>(node->Integer(1, kMostPixelsASide)) : 0;
  };
  camera->width = read("image_width", "width");
  camera->height = read("image_height", "height");
}

CameraIntrinsics ReadOne(const DocumentNode& root, const DocumentNode& matrix,
                         const DocumentNode& terms) {
  const std::array<double, 4> pinhole = FocalAndCentre(ReadMatrix(matrix, 3, 3), matrix);
  const std::vector<double> coefficients = ReadMatrix(terms);
  CameraIntrinsics camera;
  if (const DocumentNode* xi = root.Find("xi")) {
    for (const double value : coefficients)
      if (value != 0)
        terms.Fail(
            "expected no distortion beside xi: the omnidirectional model with distortion is "
            "none of ours");
    if (!(xi->Number() > -1)) xi->FailExpected("a number above -1");
    camera = FromOmni(xi->Number(), pinhole[0], pinhole[1], pinhole[2], pinhole[3]);
  } else {
    camera.parameters.assign(pinhole.begin(), pinhole.end());
    if (IsTrue(root.Find("fisheye_model"))) {
      if (coefficients.size() != 4)
        terms.Fail("expected 4 coefficients of a fisheye model, found " +
                   std::to_string(coefficients.size()));
      camera.model = "angular4";
      camera.parameters.insert(camera.parameters.end(), coefficients.begin(), coefficients.end());
    } else {
      SetBrown(coefficients, terms, &camera);
    }
  }
  if (const DocumentNode* name = root.Find("camera_name")) camera.name = name->Scalar();
  ReadSize(root, &camera);
  return camera;
}

std::string Matrix(const std::string& name, int rows, int columns,
                   const std::vector<double>& values) {
  return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: " + NumberList(values) +
         "\n";
}

// Which keys a model is written with: the terms last, so that a file that is cut short lacks them.
struct Terms {
  std::string kind;  // what comes before the matrices
  std::vector<double> matrix, coefficients;
};

Terms TermsOf(const CameraIntrinsics& camera) {
  const std::vector<double>& p = camera.parameters;
  Terms terms{"fisheye_model: 0\n", {p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1}, {}};
  if (const auto brown = BrownTerms(camera)) {
    terms.coefficients.assign(brown->begin(),
                              brown->begin() + static_cast<long>(BrownCount(*brown)));
  } else if (const auto angular = AngularTerms(camera)) {
    terms.kind = "fisheye_model: 1\n";
    terms.coefficients.assign(angular->begin(), angular->end());
  } else {
    const Omni omni = ToOmni(camera, *UnifiedAlpha(camera));
    terms.kind = "xi: ";
    AppendNumber(&terms.kind, omni.xi);
    terms.kind += "\n";
    terms.matrix[0] = omni.fx;
    terms.matrix[4] = omni.fy;
    terms.coefficients = {0, 0, 0, 0};
  }
  return terms;
}

}  // namespace

CameraRig ReadOpenCvCameras(const DocumentNode& root) {
  CameraRig rig;
  if (!root.Find("M1") && !root.Find("K1")) {
    rig.cameras.push_back(
        {ReadOne(root, FirstOf(root, kMatrixNames), FirstOf(root, kTermsNames)), kCameraAtRig, {}});
    return rig;
  }
  for (const char* number : {"1", "2"}) {
    const std::string n = number;
    const DocumentNode* matrix = root.Find("M" + n);
    RigCamera camera;
    camera.intrinsics =
        ReadOne(root, matrix ? *matrix : root.Member("K" + n), root.Member("D" + n));
    camera.intrinsics.name = "cam" + std::to_string(rig.cameras.size());
    rig.cameras.push_back(std::move(camera));
  }
  // stereo_calib writes R and T to a file of their own.
  if (const DocumentNode* rotation = root.Find("R")) {
    const std::vector<double> t = ReadMatrix(root.Member("T"), 3, 1);
    const std::vector<double> r = ReadMatrix(*rotation, 3, 3);
    if (!IsRotation(r.data())) rotation->Fail("expected a rotation");
    rig.cameras[1].camera_from_rig = PoseOf(r.data(), t.data());
  }
  return rig;
}

std::string FormatOpenCvCameras(const CameraRig& rig) {
  const CameraIntrinsics& first = rig.cameras[0].intrinsics;
  std::string text = "%YAML:1.0\n---\n";
  const Terms terms = TermsOf(first);
  const std::string size = "image_width: " + std::to_string(first.width) +
                           "\nimage_height: " + std::to_string(first.height) + "\n";
  if (rig.cameras.size() == 1) {
    if (!first.name.empty()) text += "camera_name: " + JsonQuoted(first.name) + "\n";
    return text + size + terms.kind + Matrix("camera_matrix", 3, 3, terms.matrix) +
           Matrix("distortion_coefficients", static_cast<int>(terms.coefficients.size()), 1,
                  terms.coefficients);
  }
  const CameraIntrinsics& second = rig.cameras[1].intrinsics;
  const Terms other = TermsOf(second);
  if (first.width != second.width || first.height != second.height || terms.kind != other.kind)
    throw Error(
        "OpenCV's file of two cameras has one size and one kind of model for both; kalibr "
        "and graticule hold these",
        ErrorKind::kUsage);
  const CameraPose second_from_first =
      Compose(rig.cameras[1].camera_from_rig, Inverse(rig.cameras[0].camera_from_rig));
  const std::array<double, 9> r = RotationMatrixOf(second_from_first);
  return text + size + terms.kind + Matrix("M1", 3, 3, terms.matrix) +
         Matrix("D1", 1, static_cast<int>(terms.coefficients.size()), terms.coefficients) +
         Matrix("M2", 3, 3, other.matrix) + Matrix("R", 3, 3, {r.begin(), r.end()}) +
         Matrix("T", 3, 1, {second_from_first.begin(), second_from_first.begin() + 3}) +
         Matrix("D2", 1, static_cast<int>(other.coefficients.size()), other.coefficients);
}

}  // namespace graticule
