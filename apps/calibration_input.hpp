#pragma once

#include <string>
#include <vector>

#include "console.hpp"
#include "graticule/io/detections.hpp"

namespace graticule::apps {

/// The corners that a command's words lead to: recorded detections (.json, .vnl, .orpc), or images
/// in which a target is looked for.  Throws Error.
Detections LoadDetections(const std::vector<std::string>& sources, const Console& console);

/// "13 views of cam0 (640 x 480), 702 corners".
std::string Described(const Detections& detections);

}  // namespace graticule::apps
