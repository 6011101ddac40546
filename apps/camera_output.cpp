#include "camera_output.hpp"

#include "problem.hpp"

namespace graticule::apps {

std::vector<CameraOutput> CameraOutputsOf(const std::vector<std::string>& words) {
  std::vector<CameraOutput> outputs;
  for (const std::string& word : words) {
    const std::size_t colon = word.find(':');
    if (colon == std::string::npos || colon == 0)
      outputs.push_back({std::nullopt, word});
    else
      outputs.push_back({CameraFormatFromWord(word.substr(0, colon)), word.substr(colon + 1)});
    ExpectWritable(outputs.back().path);
  }
  return outputs;
}

void WriteAll(const std::vector<CameraOutput>& outputs, const CameraRig& rig) {
  for (const CameraOutput& output : outputs) WriteCameras(output.path, rig, output.format);
}

}  // namespace graticule::apps
