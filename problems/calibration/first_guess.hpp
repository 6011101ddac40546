#pragma once

#include <vector>

#include "graticule/problems/calibration/calibrate.hpp"
#include "graticule/problems/calibration/target_pose.hpp"

namespace graticule {

/// A camera's first estimate, from nothing but corners of a flat target.
struct FirstGuess {
  CameraIntrinsics camera;  ///< angular4
  double median_px = 0;     ///< over the views looked at, of their reprojection error
  double focal_px = 0;      ///< of the shape it began with
  const char* shape = "";   ///< "straight", "stereographic", "equidistant", "equisolid"
};

/// What a camera may be before anything was estimated: its centre near the middle of the image, its
/// focal lengths nearly alike, its angular terms near the series of a common lens.  `width` scales
/// it: 1 is tight, for few views.
CameraPrior FirstPrior(const CameraIntrinsics& camera, double width);

/// First estimates of one camera, best first; empty where no view has six corners.
///
/// A range of focal lengths and four shapes of lens are tried.  For each the pixels become rays,
/// and the rays of a view a pose of the target (PoseFromRays), which needs no focal length to be
/// known and serves lenses that see behind themselves.  The best few are solved as angular4 under
/// FirstPrior, tight first, then wide.  It does not depend on the order of the views.
std::vector<FirstGuess> GuessCamera(const Registry& types, const Detections& detections,
                                    std::size_t camera);

/// The corners of a view, the target as the state has it.
CornerPairs PairsOf(const CalibrationState& state, const TargetView& view);

}  // namespace graticule
