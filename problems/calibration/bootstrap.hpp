#pragma once

#include "graticule/problems/calibration/calibrate.hpp"
#include "graticule/problems/calibration/fit_model.hpp"

namespace graticule {

/// Gives every exposure that has none a pose, and looks again at those whose views are off by more
/// than `farthest_px`; an exposure that stays off has none.
void PlaceTargets(const Detections& detections, double farthest_px, CalibrationState* state);

/// A calibration from detections alone: no focal length, no start, no order of frames.
///
/// Each camera by GuessCamera, the rig from exposures that several cameras saw, all solved
/// together, then with the model that the options ask for.  Throws Error: kIllPosed where nothing
/// can be said (a camera without a usable view, cameras that never saw the target together).
Calibration BootstrapCalibration(const Registry& types, const Detections& detections,
                                 const CalibrationOptions& options);

/// One camera of a state in the terms of another model, over the pixels that its views have.
FittedModel FitModelTo(const Registry& types, const Detections& detections,
                       const CalibrationState& state, std::size_t camera, const std::string& model);

/// The same calibration with another model, begun at this one.
Calibration ChangeModel(const Registry& types, const Detections& detections,
                        const CalibrationState& state, const CalibrationOptions& options);

}  // namespace graticule
