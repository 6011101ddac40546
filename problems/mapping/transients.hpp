#pragma once

#include "graticule/problems/mapping/occupancy_map.hpp"

namespace graticule {

/// What the vote removed from a map (thesis section 2.5), as a layer of its own on the map's cells:
/// structure where beams have ended, though more passed through (somebody walked there; what stood
/// there was taken away; the fringe of a wall); free where the map knows the cell and nothing was
/// removed; unknown where it is unknown.  A cell of the map's structure is free in the layer.
OccupancyGrid TransientsOf(const OccupancyMap& map);

}  // namespace graticule
