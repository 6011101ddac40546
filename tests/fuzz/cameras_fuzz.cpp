#include "fuzz.hpp"
#include "graticule/io/camera_file.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  const CameraRig rig = ParseCameras(text, "fuzz.yaml");
  for (const CameraFormat format :
       {CameraFormat::kGraticule, CameraFormat::kOpenCv, CameraFormat::kRos, CameraFormat::kKalibr,
        CameraFormat::kMrcal}) {
    std::string once;
    try {
      once = FormatCameras(rig, format);
    } catch (const Error&) {
      continue;  // a model that the format does not have
    }
    // What was written must be read; of an omnidirectional model, up to rounding.
    const CameraRig again = ParseCameras(once, "again.yaml");
    if (again.cameras.size() != rig.cameras.size()) std::abort();
    if (format == CameraFormat::kGraticule && FormatCameras(again, format) != once) std::abort();
  }
}
