#include <fmt/core.h>

#include <filesystem>

#include "commands.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/io/rig.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"

namespace graticule::apps {

int Run(const SimulateSceneCommand& command, const Console&) {
  SceneOptions options;
  options.seed = command.seed;
  const SimulatedScene scene = SimulateScene(command.scene, options);
  std::error_code error;
  std::filesystem::create_directories(command.output, error);
  if (error) throw Error(command.output + ": " + error.message(), ErrorKind::kOther);
  const std::string folder = command.output + "/";
  WriteCloud(folder + "scan.pcd", scene.cloud);
  WriteFile(folder + "image.png", FormatPng(scene.image));
  LidarRig rig;
  rig.camera = scene.camera;
  rig.camera_from_lidar = scene.camera_from_lidar;
  WriteRig(folder + "rig.yaml", rig);
  fmt::print("{}scan.pcd, image.png, rig.yaml: {} x {} points with their true labels\n", folder,
             scene.cloud.width, scene.cloud.height);
  return kDone;
}

}  // namespace graticule::apps
