#include "graticule/problems/urban/town_camera.hpp"

#include "graticule/problems/calibration/render.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/problems/random.hpp"

namespace graticule {
namespace {

// Streams of a mission's seed: a camera's make, hands and the noise of pixels.
enum Stream : std::uint64_t { kCameras = 101, kHands = 1001, kPixels = 2001 };

}  // namespace

CameraIntrinsics TownCamera(std::size_t robot, std::uint64_t seed) {
  CameraIntrinsics camera = StudyLenses()[4].camera;
  RandomNumbers random(seed, kCameras + robot);
  camera.parameters[0] *= 1 + 0.01 * random.Normal();
  camera.parameters[1] = camera.parameters[0] * (1 + 0.001 * random.Normal());
  camera.parameters[2] += 5 * random.Normal();
  camera.parameters[3] += 5 * random.Normal();
  for (std::size_t i = 4; i < camera.parameters.size(); ++i)
    camera.parameters[i] *= 1 + 0.05 * random.Normal();
  return camera;
}

std::vector<TargetPicture> TakePictures(const CameraIntrinsics& intrinsics, const Target& target,
                                        std::size_t count, std::uint64_t seed) {
  const Camera camera(intrinsics);
  const TargetRenderer renderer(target, camera);
  const TargetLayout layout = LayoutOf(target);
  std::vector<TargetPicture> pictures;
  for (std::size_t frame = 0; frame < count; ++frame) {
    RandomNumbers hands(seed, kHands + frame), pixels(seed, kPixels + frame);
    const Se3Array pose = PoseByPerson(Person::kRosRules, frame, camera, layout, hands);
    pictures.push_back({renderer.Render(pose, &pixels), pose});
  }
  return pictures;
}

}  // namespace graticule
