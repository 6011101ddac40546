#include "graticule/io/camera_formats.hpp"
#include "graticule/io/json_document.hpp"
#include "graticule/io/text.hpp"

namespace graticule {

CameraRig ReadMrcalCamera(const DocumentNode& root) {
  const DocumentNode& model = root.Member("lensmodel");
  const std::string& word = model.Scalar();
  const struct {
    const char* name;
    std::size_t terms;
  } models[] = {{"LENSMODEL_PINHOLE", 0},
                {"LENSMODEL_OPENCV4", 4},
                {"LENSMODEL_OPENCV5", 5},
                {"LENSMODEL_OPENCV8", 8},
                {"LENSMODEL_OPENCV12", 12}};
  CameraIntrinsics camera;
  for (const auto& known : models) {
    if (word != known.name) continue;
    const DocumentNode& numbers = root.Member("intrinsics");
    const std::vector<double> p = numbers.Numbers(4 + known.terms);
    if (!(p[0] > 0 && p[1] > 0)) numbers.Fail("expected focal lengths above zero");
    camera.parameters.assign(p.begin(), p.begin() + 4);
    SetBrown({p.begin() + 4, p.end()}, numbers, &camera);
  }
  if (camera.model.empty())
    model.FailExpected(
        "LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, LENSMODEL_OPENCV5 or LENSMODEL_OPENCV8 (none of our "
        "models can say another)");
  const DocumentNode& size = root.Member("imagersize");
  if (size.List().values.size() != 2) size.FailExpected("a list of 2 numbers");
  camera.width = static_cast<int>(size.values[0].Integer(1, kMostPixelsASide));
  camera.height = static_cast<int>(size.values[1].Integer(1, kMostPixelsASide));

  // Rodrigues' vector and translation, camera from reference; its name changed with mrcal 2.5.
  const DocumentNode* pose = root.Find("rt_cam_ref");
  const std::vector<double> rt = (pose ? *pose : root.Member("extrinsics")).Numbers(6);
  CameraRig rig;
  rig.cameras.push_back({camera, PoseOfRotationVector(rt.data()), {}});
  return rig;
}

std::string FormatMrcalCamera(const CameraRig& rig) {
  const CameraIntrinsics& camera = rig.cameras[0].intrinsics;
  const std::array<double, 8> terms = *BrownTerms(camera);
  const std::size_t count = camera.model == "pinhole" ? 0 : BrownCount(terms);
  std::vector<double> p(camera.parameters.begin(), camera.parameters.begin() + 4);
  p.insert(p.end(), terms.begin(), terms.begin() + static_cast<long>(count));
  const std::array<double, 6> pose = RotationVectorOf(rig.cameras[0].camera_from_rig);
  return "# made by graticule\n{\n    'lensmodel':  'LENSMODEL_" +
         (count == 0 ? "PINHOLE" : "OPENCV" + std::to_string(count)) +
         "',\n\n    # fx fy cx cy, then the distortion\n    'intrinsics': " + NumberList(p) +
         ",\n\n    # rt_fromref\n    'extrinsics': " + NumberList(pose) +
         ",\n\n    'imagersize': [" + std::to_string(camera.width) + ", " +
         std::to_string(camera.height) + "],\n}\n";
}

}  // namespace graticule
