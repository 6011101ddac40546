#pragma once

#include <cstddef>

#include "graticule/io/planar_pose.hpp"
#include "graticule/problems/mapping/occupancy_map.hpp"

namespace graticule {

/// How two small maps speak against lying on each other: structure of the one where the other has
/// seen through.
struct SightConflict {
  std::size_t agree = 0;     ///< cells of structure with structure of the other near
  std::size_t conflict = 0;  ///< with none near, and free ground all round, there

  /// 0 where too little is in sight of both to tell.
  double Share() const;
};

/// Of each map's structure what the other says about it, where `a_from_b` puts them.  "Near" is
/// within two cells, as poses and maps are not exact.
SightConflict ConflictOf(const OccupancyMap& a, const OccupancyMap& b, const PlanarPose& a_from_b);

}  // namespace graticule
