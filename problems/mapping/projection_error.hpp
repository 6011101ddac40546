#pragma once

#include "graticule/problems/mapping/rasteriser.hpp"

namespace graticule {

/// How far the end of a scan's beam, or its laser, has moved between two poses at most, m: the
/// projection error of Algorithm 2.1, line 10, on all that the scan has seen.
double ProjectionError(const ScanPoints& points, const PlanarPose& world_from_then,
                       const PlanarPose& world_from_now);

/// Whether that is more than `limit`, mostly without looking at the beams.
bool ProjectionErrorExceeds(double limit, const ScanPoints& points,
                            const PlanarPose& world_from_then, const PlanarPose& world_from_now);

}  // namespace graticule
