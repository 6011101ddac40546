#pragma once

#include <optional>
#include <vector>

#include "graticule/problems/calibration/calibrate.hpp"

namespace graticule {

/// Distances of corners from where a calibration predicts them [px].
struct ReprojectionError {
  std::size_t views = 0, corners = 0;
  std::size_t unseen = 0;  ///< corners that the model has no image of; they do not count below
  double mean_px = 0, rms_px = 0, median_px = 0, percentile_995_px = 0, max_px = 0;
};

/// Summary of distances; reorders them.
ReprojectionError SummariseErrors(std::vector<double>* distances_px);

/// Mean distance [px] as models are compared by it, which a corner that is far off does not rule; a
/// corner without an image counts as 10 px.  NaN where there is no corner at all.
double HeldOutError_px(const ReprojectionError& error);

/// A calibration on views that it was not made from (thesis, section 5.5): the target's pose is
/// optimised for every view, the cameras, the target's shape and the rig stay.  Views that no
/// pose explains count as unseen.
///
/// `distances_px`, unless null, receives every corner's distance, in the order of the views, NaN
/// where there is none.  `starts`, unless null: poses by exposure that are nearly right, instead of
/// looking everywhere.
ReprojectionError EvaluateOn(const CalibrationState& calibration, const Detections& test,
                             std::vector<std::vector<double>>* distances_px = nullptr,
                             const std::vector<std::optional<Se3Array>>* starts = nullptr);

/// The same for exposures left out in turn: `folds` calibrations, each made without its share of
/// the exposures and evaluated on them.  Each begins at the whole calibration.
///
/// `by_exposure`, unless null, receives each exposure's errors over all its views; `views` in it is
/// 0.
ReprojectionError CrossValidate(const Registry& types, const Detections& detections,
                                const Calibration& calibration, const CalibrationOptions& options,
                                int folds, std::vector<ReprojectionError>* by_exposure = nullptr);

}  // namespace graticule
