#pragma once

#include <string>
#include <utility>
#include <vector>

namespace graticule {

/// What a method of segmentation scores with some numbers: means over scans.
struct SegmentSweepRow {
  std::string method;
  std::vector<double> values;  ///< of the sweep's parameters; NaN: the method has it not
  double weighted_overlap = 0, achievable = 0, under_segmentation = 0, boundary_recall = 0;
  double mean_f = 0, found = 0, segments = 0;
  double seconds = 0;  ///< CPU time a scan
};

struct SegmentSweepReport {
  std::vector<std::string> scans;       ///< their files
  std::vector<std::string> parameters;  ///< "k-rgb"; none: only the methods are compared
  std::vector<SegmentSweepRow> rows;    ///< those of a method together
};

/// Of each method the row with the largest mean of weighted overlap and F.
std::vector<const SegmentSweepRow*> BestOfEachMethod(const SegmentSweepReport& report);

/// One drawing: of each parameter a column, of each score a chart over the parameter, of each
/// method a curve.  Where several parameters are swept, a curve has at each value the row with the
/// largest mean of overlap and F over the other parameters.  SVG.
std::string SegmentSweepSvg(const SegmentSweepReport& report);

/// One self-contained page: the best of each method, the charts, and all rows.
std::string SegmentSweepHtml(const SegmentSweepReport& report);

/// A scan that was parted into segments.
struct SegmentReport {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  ///< "method" "convex", in order
  struct Picture {
    std::string title, png;
    std::size_t width = 0, height = 0;
  };
  std::vector<Picture> pictures;
  struct Segment {
    std::size_t label = 0, points = 0;
    std::string centre, extent;  ///< [m]
    double off_plane_m = 0;
    std::string mean_colour;  ///< "#rrggbb", or ""
  };
  std::vector<Segment> segments;
};

/// One self-contained page: facts, pictures, and the segments, the largest first.
std::string SegmentReportHtml(const SegmentReport& report);

}  // namespace graticule
