#pragma once

#include <vector>

#include "graticule/problems/mapping/surface_points.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// Angles from `centre - half` to `centre + half`.
struct TurnRange {
  double centre = 0, half = 0;  ///< rad
};

/// By which turns one set of points may be the other: those at which the directions that their
/// surfaces face (a histogram of normals, which does not change with the place) agree at least this
/// share as well as at the best turn.  Among walls at right angles these are four narrow ranges,
/// where nothing has a direction the whole circle.  Ranges do not overlap, but for their edges.
std::vector<TurnRange> LikelyTurns(Span<const SurfacePoint> reference,
                                   Span<const SurfacePoint> scan, double share = 0.6);

}  // namespace graticule
