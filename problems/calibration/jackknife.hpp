#pragma once

#include "graticule/problems/calibration/posterior.hpp"

namespace graticule {

/// Raises a posterior's covariance to what its views say of each other.
///
/// Corners of one view err together: the board is bent otherwise than the model says, the lens is
/// out of focus there, the shutter rolls.  Deviations that take every corner for itself are then
/// too small by factors (1.5 to 5 on recorded sets).  Left out one after the other, exposures move
/// the answer by what they disagree: the jackknife (Miller 1974; for clusters: Bell and McCaffrey
/// 2002, CR3), each by one Newton step in closed form.  Where along some direction that variance is
/// larger than the posterior's, it takes its place; it is never made smaller.  Of cameras, rig and
/// warp; free corners keep theirs.
///
/// Returns by how much the mean variance grew; 1 with fewer than four exposures, which cannot judge
/// each other.
double RaiseByJackknife(const Detections& detections, const CalibrationState& state,
                        const CornerUse& use, const PosteriorOptions& options,
                        Posterior* posterior);

}  // namespace graticule
