#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graticule/io/camera_file.hpp"

namespace graticule::apps {

/// Where a camera is written, as `-o` says it: "ros:camera.yaml" as a format and a path; without a
/// colon all is the path.
struct CameraOutput {
  std::optional<CameraFormat> format;
  std::string path;
};

/// Throws Error: a word before the colon that is no format (kUsage), a folder that cannot be
/// written.
std::vector<CameraOutput> CameraOutputsOf(const std::vector<std::string>& words);
void WriteAll(const std::vector<CameraOutput>& outputs, const CameraRig& rig);

}  // namespace graticule::apps
