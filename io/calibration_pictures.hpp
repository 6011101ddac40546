#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "graticule/io/chart.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/io/image_field.hpp"

namespace graticule {

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

/// Lines over an image.
using ImageLine = std::vector<ImagePoint>;

/// A heat map: how far the calibration's pixels may be off (thesis, section 5.2.2), or how far two
/// calibrations are apart.
struct ErrorMap {
  std::string title;     ///< "Expected reprojection error"
  std::string subtitle;  ///< of which kind: "the rotation of the camera taken out; at infinity"
  ImageField field;      ///< px; NaN where no ray has its image
  /// One a node: whether a target's corner was seen near it; empty: everywhere.
  std::vector<std::uint8_t> seen;
  double max_px = kNotKnown;   ///< the number that counts; NaN: the field's largest
  ImagePoint max_at;           ///< if max_px is known
  double mean_px = kNotKnown;  ///< shown if known
  double limit_px = 0;         ///< a bold contour here: what was asked for; 0: none
};
/// Filled contours at round values with a bar, hatched where nothing was seen, grey where no ray
/// is; the largest value marked.
std::string DrawErrorMap(const ErrorMap& map);

/// A corner of a view, and how far from it the calibration predicts it.
struct CornerResidual {
  std::size_t view = 0;  ///< into the report's views of this camera
  int id = 0;
  ImagePoint seen, off;  ///< px; off: predicted - seen
  bool outlier = false;  ///< was set aside
};
enum class ResidualColours { kBySize, kByView };
/// Arrows, exaggerated to be seen, with one that says how much; outliers as crosses, not longer
/// than the plot.
struct ResidualPicture {
  std::string title = "Residuals";
  int width = 0, height = 0;  ///< of the image [px]
  std::vector<CornerResidual> corners;
  ResidualColours colours = ResidualColours::kBySize;
};
std::string DrawResiduals(const ResidualPicture& picture);

/// A histogram of the residuals of both axes against a Gaussian of `sigma_px`, and how far it is
/// from one.
std::string DrawResidualHistogram(const std::vector<CornerResidual>& corners, double sigma_px);

/// One bar a view.
struct ViewBar {
  std::string name;
  double rms_px = kNotKnown;
  double held_out_px = kNotKnown;  ///< cross-validated, where it is known
  std::size_t outliers = 0;
};
std::string DrawViewBars(const std::vector<ViewBar>& views);

/// Where targets were seen.
struct CoveragePicture {
  std::string title = "Coverage";
  int width = 0, height = 0;  ///< of the image [px]
  std::vector<ImagePoint> corners;
  std::vector<ImageLine> outlines;  ///< closed, one a view
  struct Ring {
    double angle_deg = 0;  ///< from the optical axis
    std::vector<ImageLine> lines;
  };
  std::vector<Ring> rings;
  ImagePoint centre;  ///< of the projection
  std::optional<GreyImage> image;
};
std::string DrawCoverage(const CoveragePicture& picture);

/// Before and after undistortion: images where there are some, lines of a grid else, or both.
struct UndistortionPicture {
  struct Side {
    std::string title;  ///< "as the camera sees it"
    int width = 0, height = 0;
    std::optional<GreyImage> image;
    std::vector<ImageLine> grid;   ///< straight lines of space
    std::vector<ImageLine> marks;  ///< rows of a target's corners, as they were seen
  };
  Side before, after;
  std::string note;  ///< "focal length 410 px keeps all pixels"
};
std::string DrawUndistortion(const UndistortionPicture& picture);

/// How the error grows from the centre of projection to the farthest corner of the image (thesis,
/// Figure 5.6 d).
struct CrossSection {
  std::string title = "Cross section from the centre to the farthest corner";
  std::vector<Curve> curves;  ///< x: distance from the centre [px], y: px
  double seen_to_px = 0;      ///< how far out corners were seen along it; 0: not known
  double limit_px = 0;        ///< what was asked for; 0: none
};
std::string DrawCrossSection(const CrossSection& section);

/// The radius of an image over the angle from the optical axis, against lenses of theory.
struct DistortionCurve {
  struct Point {
    double angle_deg = 0, radius_px = 0;
    double deviation_px = 0;  ///< standard deviation of the radius
  };
  std::string model;
  double focal_px = 0;  ///< of the lenses of theory
  std::vector<Point> points;
  double seen_to_deg = 0;  ///< the widest angle of a corner; 0: not known
  /// The band is drawn this many standard deviations wide: it would not be seen else.
  double exaggeration = 1;
};
std::string DrawDistortion(const DistortionCurve& curve);

/// How the board differs from its description [m].
struct BoardPicture {
  std::string title = "Shape of the board";
  struct Corner {
    double x = 0, y = 0;            ///< as described
    double dx = 0, dy = 0, dz = 0;  ///< found - described, after the best rigid motion
  };
  std::vector<Corner> corners;
};
std::string DrawBoard(const BoardPicture& picture);

/// Where to hold the target next, as it would appear.
struct SuggestionPicture {
  std::string title = "Next, hold the target here";
  int width = 0, height = 0;
  std::vector<ImageLine> quads;  ///< closed, of tags or squares, as suggested
  std::vector<int> names;        ///< one a quad, for its colour; empty: their order
  std::vector<ImageLine> live;   ///< as they are now, solid; may be empty
  std::vector<std::string> advice;
  double max_px_after = kNotKnown;  ///< the largest error that is expected then
  std::optional<GreyImage> image;
};
std::string DrawSuggestion(const SuggestionPicture& picture);

/// A model that was tried.
struct TriedModel {
  std::string name;   ///< "angular4"
  std::string board;  ///< "flat"
  int parameters = 0;
  double rms_px = kNotKnown, held_out_mean_px = kNotKnown, held_out_rms_px = kNotKnown;
  double percentile_995_px = kNotKnown, max_px = kNotKnown;
  double difference_px = kNotKnown;      ///< of the mean to the best model's
  double standard_error_px = kNotKnown;  ///< of that difference
  double bic = kNotKnown;                ///< less the best one's
  bool converged = false, chosen = false;
  std::string failure;  ///< "" or why there is no error
};
std::string DrawModels(const std::string& title, const std::vector<TriedModel>& models);

}  // namespace graticule
