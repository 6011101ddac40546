#include <algorithm>

#include "graticule/io/camera_formats.hpp"
#include "graticule/io/json_document.hpp"
#include "graticule/io/text.hpp"

namespace graticule {
namespace {

// A matrix of a camera_info file ({rows, cols, data}), or of a printed message (a list).
std::vector<double> MatrixOrList(const DocumentNode& node) {
  return node.IsList() ? node.Numbers() : ReadMatrix(node);
}

const DocumentNode& OneOf(const DocumentNode& root, const char* file, const char* message,
                          const char* lower) {
  for (const char* name : {file, message, lower})
    if (const DocumentNode* found = root.Find(name)) return *found;
  return root.Member(file);
}

std::string Matrix(const char* name, int rows, int columns, const std::vector<double>& values) {
  return std::string(name) + ":\n  rows: " + std::to_string(rows) +
         "\n  cols: " + std::to_string(columns) + "\n  data: " + NumberList(values) + "\n";
}

}  // namespace

CameraRig ReadRosCamera(const DocumentNode& root) {
  CameraIntrinsics camera;
  if (const DocumentNode* name = root.Find("camera_name")) camera.name = name->Scalar();
  camera.width =
      static_cast<int>(OneOf(root, "image_width", "width", "width").Integer(1, kMostPixelsASide));
  camera.height = static_cast<int>(
      OneOf(root, "image_height", "height", "height").Integer(1, kMostPixelsASide));
  const DocumentNode& matrix = OneOf(root, "camera_matrix", "K", "k");
  const std::vector<double> k = MatrixOrList(matrix);
  if (k.size() != 9) matrix.Fail("expected a matrix of 3 x 3");
  const std::array<double, 4> pinhole = FocalAndCentre(k, matrix);
  camera.parameters.assign(pinhole.begin(), pinhole.end());

  const DocumentNode& model = root.Member("distortion_model");
  const std::string& word = model.Scalar();
  const DocumentNode& terms = OneOf(root, "distortion_coefficients", "D", "d");
  const std::vector<double> d = MatrixOrList(terms);
  if (word == "plumb_bob" || word == "rational_polynomial" || word == "none") {
    SetBrown(d, terms, &camera);
  } else if (word == "equidistant" || word == "fisheye") {
    if (d.size() != 4)
      terms.Fail("expected 4 coefficients of " + word + ", found " + std::to_string(d.size()));
    camera.model = "angular4";
    camera.parameters.insert(camera.parameters.end(), d.begin(), d.end());
  } else {
    model.FailExpected("plumb_bob, rational_polynomial or equidistant");
  }
  // ROS reads nothing without them either.
  const DocumentNode& rectification = OneOf(root, "rectification_matrix", "R", "r");
  if (MatrixOrList(rectification).size() != 9) rectification.Fail("expected a matrix of 3 x 3");
  const DocumentNode& projection = OneOf(root, "projection_matrix", "P", "p");
  if (MatrixOrList(projection).size() != 12) projection.Fail("expected a matrix of 3 x 4");
  CameraRig rig;
  rig.cameras.push_back({camera, kCameraAtRig, {}});
  return rig;
}

std::string FormatRosCamera(const CameraRig& rig) {
  const CameraIntrinsics& camera = rig.cameras[0].intrinsics;
  const std::vector<double>& p = camera.parameters;
  std::string model;
  std::vector<double> terms;
  if (const auto brown = BrownTerms(camera)) {
    // plumb_bob has five, whether or not the last is zero.
    const std::size_t count = std::max<std::size_t>(BrownCount(*brown), 5);
    model = count == 8 ? "rational_polynomial" : "plumb_bob";
    terms.assign(brown->begin(), brown->begin() + static_cast<long>(count));
  } else {
    const auto angular = *AngularTerms(camera);
    model = "equidistant";
    terms.assign(angular.begin(), angular.end());
  }
  return "image_width: " + std::to_string(camera.width) +
         "\nimage_height: " + std::to_string(camera.height) +
         "\ncamera_name: " + JsonQuoted(camera.name.empty() ? "camera" : camera.name) + "\n" +
         Matrix("camera_matrix", 3, 3, {p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1}) +
         "distortion_model: " + model + "\n" +
         Matrix("distortion_coefficients", 1, static_cast<int>(terms.size()), terms) +
         Matrix("rectification_matrix", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}) +
         Matrix("projection_matrix", 3, 4, {p[0], 0, p[2], 0, 0, p[1], p[3], 0, 0, 0, 1, 0});
}

}  // namespace graticule
