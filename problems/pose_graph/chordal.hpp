#pragma once

#include <cstddef>

#include "graticule/problems/pose_graph/landmarks.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

struct ChordalReport {
  std::size_t poses = 0;        ///< that were given a new value
  std::size_t pieces = 0;       ///< that were solved for
  std::size_t kept_pieces = 0;  ///< that stayed as they were: their system is singular
  PlacedLandmarks landmarks;    ///< placed jointly with the poses, or from a sighting after them
};

/// Chordal initialisation: the rotations by linear least squares, then the translations likewise.
///
/// 1. Rotation matrices, freed of their constraint, minimise the sum over the between factors of
///    kappa |R_b - R_a R_ab|^2 (Frobenius) and over the priors of kappa |R - R_prior|^2, and are
///    then replaced by the nearest rotations.  kappa is the harmonic mean of the rotation's
///    information: 1 / (trace(W_rotation^-1) / n), a quarter of it where the residual is half the
///    angle.
/// 2. With these rotations, the positions of poses and landmarks minimise the graph's own cost
///    (without losses) over all factors that are linear in them: between, prior, position and
///    landmark factors exactly, bearing with range linearised at what was measured.
///
/// `values` hold a spanning tree's values with landmarks, and are what both systems start from: a
/// measurement that the tree satisfies adds nothing to them, not even rounding.  Held at these
/// values are fixed variables, and in a piece (poses joined by between factors) with neither a
/// fixed pose nor a prior that says all of a pose, the smallest key: its gauge.  Landmarks and
/// positions do not move such a piece as a whole.  Where factors that measure only some components
/// leave a pose of a piece undetermined, the whole piece keeps the tree's values.
///
/// Both systems share one symbolic analysis unless there are landmarks.  Deterministic.
/// After L. Carlone, R. Tron, K. Daniilidis, F. Dellaert, "Initialization techniques for 3D SLAM"
/// (ICRA 2015), and D. Rosen et al., "SE-Sync" (IJRR 2019), section 4.
ChordalReport PlaceByChordal(const Graph& graph, Values* values);

}  // namespace graticule
