#pragma once

#include "graticule/problems/mapping/scan_points.hpp"

namespace graticule {

/// How far the end of a scan's beam, or its laser, has moved between two poses at most, m: the
/// projection error of Algorithm 2.1, line 10, on all that the scan has seen.  Found on its hull:
/// how far a place is moved is a convex function of the place.
double ProjectionError(const ScanPoints& points, const PlanarPose& world_from_then,
                       const PlanarPose& world_from_now);

/// What is known of it without looking at the beams, from the scan's reach alone.
enum class Bound { kWithin, kBeyond, kOpen };
Bound ProjectionErrorBound(double limit, double reach, const PlanarPose& world_from_then,
                           const PlanarPose& world_from_now);

/// A bound from above, m.
double ProjectionErrorAtMost(double reach, const PlanarPose& world_from_then,
                             const PlanarPose& world_from_now);

/// Whether it is more than `limit`.
bool ProjectionErrorExceeds(double limit, const ScanPoints& points,
                            const PlanarPose& world_from_then, const PlanarPose& world_from_now);

}  // namespace graticule
