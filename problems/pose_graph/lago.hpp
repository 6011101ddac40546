#pragma once

#include <cstddef>

#include "graticule/problems/pose_graph/landmarks.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

struct LagoReport {
  std::size_t poses = 0;        ///< that were given a new value
  std::size_t kept_pieces = 0;  ///< that stayed as they were: their system is singular
  PlacedLandmarks landmarks;    ///< from a sighting, after the poses
};

/// Linear approximation of a graph of the plane: two linear least squares problems over the between
/// and prior factors.
///
/// 1. Angles.  An angle is measured up to a whole turn; around a cycle the turns must add up.  In
/// the
///    fundamental cycle that a between factor closes over the spanning tree, its turns are those
///    that bring the cycle's sum nearest to zero (rounding).  With the turns settled the angles are
///    a linear problem, weighted by the inverse variances of the measured angles.
/// 2. Poses.  Turned by these angles, the measured translations are linear in the positions, and to
///    first order in a further correction of the angles.  Positions and corrections together
///    minimise |r|^2_W over both parts of the residual with the factors' whole information, so that
///    what was measured of the positions improves the angles.
///
/// `values` hold the spanning tree's values.  Held at these are fixed poses, and in a piece with
/// neither a fixed pose nor a prior that says all of a pose, its gauge; pieces that measurements of
/// single components leave loose stay as they are, like PlaceByChordal has it.  Positions
/// (position_se2) and landmarks take no part; landmarks are placed at the end.
///
/// Throws Error (kUsage) where a pose is in space (se3/1).  Deterministic.
/// After L. Carlone, R. Aragues, J. Castellanos, B. Bona, "A fast and accurate approximation for
/// planar pose graph optimization" (IJRR 2014).  There translation and angle of a measurement are
/// uncorrelated; here they may be correlated, and then step 1 takes the angles' marginal variances.
LagoReport PlaceByLago(const Graph& graph, Values* values);

}  // namespace graticule
