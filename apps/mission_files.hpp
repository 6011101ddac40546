#pragma once

#include "commands.hpp"
#include "graticule/io/map_report.hpp"
#include "graticule/problems/mapping/mission.hpp"

namespace graticule::apps {

/// Reads the logs that a command names, and makes the mission's pose graph where they have none.
/// Adds what there is to say to the report.
Mission LoadMission(const MapCommand& command, const Registry& types, MapReport* report,
                    const Console& console);

}  // namespace graticule::apps
