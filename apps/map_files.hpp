#pragma once

#include "graticule/io/map_drawing.hpp"
#include "graticule/problems/mapping/graph_sequence.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "output_folder.hpp"

namespace graticule::apps {

/// The map with trajectories and loop closures, where the last graph has them.
MapDrawing DrawingOf(const Mission& mission, const MissionStep& last, OccupancyGrid grid);

/// ROBOT.tum, and where the mission has a datum trajectories.kml and .geojson.
void WriteTrajectories(const Mission& mission, const MissionStep& last, const OutputFolder& folder);

/// graph.fg and graph.g2o.
void WriteGraph(const Mission& mission, const MissionStep& last, const OutputFolder& folder);

}  // namespace graticule::apps
