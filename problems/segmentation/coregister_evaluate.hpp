#pragma once

#include <string>
#include <vector>

#include "graticule/problems/segmentation/coregister.hpp"

namespace graticule {

/// Errors of correspondences that the estimate has not seen.
struct HeldOut {
  /// One a point: its distance from where the co-registration of all others predicts it; infinite
  /// where that is not determined, or has no image of it.
  std::vector<double> distances_px;
  double rms_px = 0;          ///< of all
  double rms_counted_px = 0;  ///< of those that were not named as outliers
  double median_px = 0;       ///< of all
};

/// Leaves each point out in turn, wrong ones too, and co-registers from the whole one's answer.
HeldOut LeaveOneOut(const Registry& types, const CoregisterData& data, const Coregistration& whole,
                    const CoregisterOptions& options);

/// A step of FreeParameters.
struct FreedParameter {
  std::string name;        ///< "fx"
  double held_out_px = 0;  ///< rms_counted_px with it
  bool is_kept = false;
};

struct FreedCoregistration {
  Coregistration solved;
  HeldOut held_out;
  CoregisterOptions options;  ///< with the parameters that are free
  /// What was tried last, best first in each round: one is kept, or the round is the last.
  std::vector<FreedParameter> tried;
};

/// Frees the camera's parameters one by one, the most useful first, as long as the error of points
/// left out falls by `least_gain` of it.  (Thesis, section 4.1, frees all sixteen.)
FreedCoregistration FreeParameters(const Registry& types, const CoregisterData& data,
                                   const Coregistration& solved, const CoregisterOptions& options,
                                   double least_gain = 0.02);

/// Names of a model's parameters: "fx", "fy", "cx", "cy", "k1".
std::vector<std::string> ParameterNames(const CameraIntrinsics& camera);

}  // namespace graticule
