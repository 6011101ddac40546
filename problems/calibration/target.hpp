#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

enum class TargetKind {
  kTagMosaic,   ///< AprilCal's: rows of tags, ten cells from one to the next
  kAprilGrid,   ///< Kalibr's: tags with small black squares between their corners
  kCharuco,     ///< a chessboard with markers in its white squares
  kChessboard,  ///< a plain one
};

/// A flat calibration target, as it is printed.
struct Target {
  TargetKind kind = TargetKind::kTagMosaic;
  /// Chessboard: inner corners.  ChArUco: squares.  Tags: tags.
  int columns = 0, rows = 0;
  /// Chessboard, ChArUco: a square's side.  Mosaic: from a tag to the next.  Grid: a tag's side
  /// with its black border (Kalibr's tagSize).  [m]
  double pitch_m = 0;
  std::string family;    ///< of its markers: marker_codes.hpp; not of a chessboard
  double marker_m = 0;   ///< ChArUco: a marker's side
  double spacing = 0.3;  ///< grid: from a tag to the next, over a tag's side (Kalibr's tagSpacing)
  int border_cells = 1;  ///< width of the markers' black border; Kalibr's grids have 2
  bool is_legacy = false;  ///< ChArUco: as OpenCV before 4.6 drew them, where rows are even
  int first_id = 0;        ///< of the markers
  int stride = 24;         ///< mosaic: from a tag's id to that of the one below it
};

/// A mosaic of tag36h11; by default AprilCal's, 1.5 inches from a tag to the next.
Target AprilCalMosaic(int columns = 8, int rows = 6, double pitch_m = 0.0381);

/// A corner that can be measured.
struct TargetCorner {
  int id = 0;
  std::array<double, 3> in_target = {};  ///< m
  /// Where four squares meet: +1 where the one at larger x and y is black (and its opposite), -1
  /// where it is white.  0: a tag's corner, where three quarters are white.
  int saddle = 0;
};

/// A marker, and where its corners are: upper left, upper right, lower right, lower left as it is
/// printed upright.
struct TargetMarker {
  int id = 0;
  std::array<std::array<double, 2>, 4> corners = {};  ///< m, in the target's frame
};

/// A black rectangle, or text.  In the target's frame [m].
struct TargetSquare {
  double x = 0, y = 0, width = 0, height = 0;
};

/// The target's frame.  Chessboard, ChArUco: corner 0 is the origin, x along the rows, y down, as
/// OpenCV has them; ids row by row.  Mosaic: the upper left corner of the upper left tag's black
/// border, x right, y down; corner k of tag t is 4 t + k, from the upper left clockwise; tag ids
/// are stride * row + column + first_id, as
/// AprilCal's (whose stride is 24).  Grid: the lower left corner of the lower left
/// tag, x right, y up; corner k of tag t is 4 t + k, from the lower left anticlockwise; tag ids row
/// by row upwards: as Kalibr's.
std::vector<TargetCorner> CornersOf(const Target& target);
std::vector<TargetMarker> MarkersOf(const Target& target);

/// Everything that is black on it.
std::vector<TargetSquare> BlackOf(const Target& target);
/// x0 y0 x1 y1 [m], in the target's frame, with the white that detection needs around it.
std::array<double, 4> ExtentOf(const Target& target);

/// Whether y runs up on the printed target.
inline bool HasYUp(const Target& target) { return target.kind == TargetKind::kAprilGrid; }

/// Throws Error (kUsage): sizes that do not fit each other, too few markers in the family.
void CheckTarget(const Target& target);

/// "chessboard of 9 x 6 corners, squares of 25 mm".
std::string Described(const Target& target);

/// YAML.  Reads Kalibr's, too (target_type: aprilgrid, checkerboard).  Throws Error
/// "name:line:column: ...".
Target ParseTarget(std::string_view text, const std::string& name);
std::string FormatTarget(const Target& target);
Target ReadTarget(const std::string& path);
void WriteTarget(const std::string& path, const Target& target);

}  // namespace graticule
