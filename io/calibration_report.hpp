#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/camera_file.hpp"

namespace graticule {

/// An estimated number with its name.
struct ReportedNumber {
  std::string name, unit;  ///< "fx", "px"
  double value = 0;
  double deviation = kNotKnown;  ///< standard deviation
  bool constrained = true;       ///< false: these views do not tell it
};

struct ReportedView {
  std::string image;
  std::size_t corners = 0, outliers = 0;
  double rms_px = kNotKnown, worst_px = kNotKnown;
  double held_out_px = kNotKnown;  ///< mean, of a calibration without it
  double distance_m = kNotKnown;   ///< of the target's middle
  double tilt_deg = kNotKnown;     ///< of the target against the ray of its middle
  std::string note;                ///< "no pose explains it", "does not match the others", or ""
};

/// A summary of distances of corners from where they are predicted [px].
struct ReportedError {
  std::string name;  ///< "held out", "test set", "fit"
  std::size_t views = 0, corners = 0, unseen = 0;
  double mean_px = kNotKnown, rms_px = kNotKnown, median_px = kNotKnown;
  double percentile_995_px = kNotKnown, max_px = kNotKnown;
};

/// A camera of the report.
struct CameraReport {
  CameraIntrinsics camera;
  std::vector<ReportedNumber> numbers;  ///< parameters, then camera_from_rig where it has one
  std::vector<ReportedView> views;
  double rms_px = kNotKnown, worst_px = kNotKnown;
  double sigma_px = kNotKnown;    ///< of either coordinate, from the residuals
  double max_ere_px = kNotKnown;  ///< that is compared with the accuracy asked for
  ImagePoint max_ere_at;
  /// Other ways to take it: {"as the parameters say, at infinity", 0.64}.
  std::vector<std::pair<std::string, double>> max_ere_variants;
  std::vector<ErrorMap> maps;  ///< expected errors; difference of two calibrations
  ResidualPicture residuals;
  CoveragePicture coverage;
  std::optional<UndistortionPicture> undistortion;
  std::optional<CrossSection> section;
  std::optional<DistortionCurve> distortion;
  std::optional<SuggestionPicture> suggestion;
};

enum class CalibrationVerdict {
  kMet,            ///< as accurate as was asked for, or nothing was asked for
  kNotMet,         ///< constrained, but not enough
  kUnconstrained,  ///< these views leave parameters open
};

/// Everything that is said of a calibration; what is empty is left out.
struct CalibrationReport {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  ///< "target" "9 x 6 corners", in order
  CalibrationVerdict verdict = CalibrationVerdict::kNotMet;
  std::string verdict_text;                ///< a sentence; "": from the numbers
  double accuracy_px = 0;                  ///< asked for; 0: nothing was
  std::vector<std::string> unconstrained;  ///< "k4 of cam0"
  std::vector<std::string> advice;         ///< what to photograph next
  std::vector<CameraReport> cameras;
  std::vector<ReportedError> errors;  ///< fit, held out, test sets
  std::vector<TriedModel> shapes, models;
  std::optional<BoardPicture> board;
  std::vector<std::pair<std::string, double>> timings;  ///< s, in order
  std::vector<std::string> warnings;
};

/// The verdict as a sentence.
std::string CalibrationVerdictText(const CalibrationReport& report);

/// One self-contained page with all pictures; no script, no network.
std::string CalibrationReportHtml(const CalibrationReport& report);

/// For programs: everything but the pictures' images and lines.
std::string CalibrationReportJson(const CalibrationReport& report);

/// A picture of the report with the name of its file, without ending.
struct NamedPicture {
  std::string name;  ///< "cam0-expected-error"
  std::string svg;
};
/// All of them, in order.
std::vector<NamedPicture> CalibrationPictures(const CalibrationReport& report);

}  // namespace graticule
