#pragma once

#include <string>

#include "graticule/problems/calibration/placement.hpp"
#include "guide_loop.hpp"
#include "guide_session.hpp"

namespace graticule::apps {

/// What the page draws over each frame.
std::string LiveJson(const LiveView& view, const TargetLayout& layout);

/// What the page says of the session, after each change.
std::string GuidanceJson(const Guidance& guidance, const TargetLayout& layout,
                         const ImageSize& image, double accuracy_px);

}  // namespace graticule::apps
