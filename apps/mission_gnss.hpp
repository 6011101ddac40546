#pragma once

#include <vector>

#include "commands.hpp"
#include "graticule/io/map_report.hpp"
#include "graticule/problems/mapping/gnss_factors.hpp"

namespace graticule::apps {

/// Lays a mission onto the fixes that `--gnss` names, those of its logs where that is `log`; tracks
/// are where its robots were.  Says in the report how well they fit.
void Georeference(const MapCommand& command, const std::vector<GnssFix>& of_logs,
                  RobotTracks tracks, Mission* mission, MapReport* report);

}  // namespace graticule::apps
