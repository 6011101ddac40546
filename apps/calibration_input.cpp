#include "calibration_input.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "graticule/io/readable.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::apps {

Detections LoadDetections(const std::vector<std::string>& sources, const Console&) {
  if (sources.empty())
    throw Error("expected recorded detections, or images to look for a target in",
                ErrorKind::kUsage);
  return ReadDetections(sources);
}

std::string Described(const Detections& detections) {
  std::string text;
  for (std::size_t c = 0; c < detections.cameras.size(); ++c) {
    std::size_t views = 0, corners = 0;
    for (const TargetView& view : detections.views) {
      if (view.camera != c) continue;
      ++views;
      corners += view.corners.size();
    }
    const ImageSize& size = detections.cameras[c];
    text += fmt::format("{}{} ({} x {}): {} views, {} corners", c > 0 ? "; " : "", size.camera,
                        size.width, size.height, views, ReadableCount(corners));
  }
  return text;
}

}  // namespace graticule::apps
