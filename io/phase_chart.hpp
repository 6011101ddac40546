#pragma once

#include <string>
#include <utility>
#include <vector>

#include "graticule/solver/report.hpp"

namespace graticule {

/// A stacked bar of the wall time of each run, by phase: an SVG document (DrawBars).  Phases that
/// took no time in any run are left out.
std::string DrawPhases(const std::string& title,
                       const std::vector<std::pair<std::string, Timing>>& runs,
                       double width_px = 760);

}  // namespace graticule
