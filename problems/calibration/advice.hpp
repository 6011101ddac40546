#pragma once

#include <string>
#include <vector>

#include "graticule/problems/calibration/posterior.hpp"

namespace graticule {

/// What a camera's views lack, in plain words: tilts (without them the focal length is not told
/// from the distance), parts of the image that no corner was seen in, views at all; what most
/// parameters are open for comes first.  Empty where nothing is missing that can be told without
/// looking for the best next pose (SuggestPose).
std::vector<std::string> AdviseViews(const Detections& detections, const CalibrationState& state,
                                     std::size_t camera, const Posterior* posterior);

}  // namespace graticule
