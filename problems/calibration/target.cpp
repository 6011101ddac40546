#include "graticule/problems/calibration/target.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "graticule/problems/calibration/marker_codes.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

bool HasMarkers(const Target& target) { return target.kind != TargetKind::kChessboard; }

/// Cells of a tag's white surround on a mosaic: its pitch is the tag's cells, its border and this.
constexpr int kMosaicGapCells = 2;

double MosaicTagSide(const Target& target, int cells) {
  const int black = cells + 2 * target.border_cells;
  return target.pitch_m * black / (black + kMosaicGapCells);
}

// ChArUco: whether the square in this column and row (from the upper left) is black.  OpenCV 4.6
// and later begin with a black one; those before began so that the lowest row's first is black,
// which differs where the number of rows is even.
bool IsBlackSquare(const Target& target, int column, int row) {
  const int shift = target.is_legacy && target.rows % 2 == 0 ? 1 : 0;
  return (column + row + shift) % 2 == 0;
}

std::array<std::array<double, 2>, 4> Square(double left, double top, double side, double down) {
  return {{{left, top},
           {left + side, top},
           {left + side, top + down * side},
           {left, top + down * side}}};
}

int MarkerCells(const Target& target) {
  // The families' sides, without making all of their codes.
  const std::string& name = target.family;
  if (name == "tag16h5") return 4;
  if (name == "tag25h9") return 5;
  if (name == "tag36h10" || name == "tag36h11") return 6;
  return name.size() > 5 ? name[5] - '0' : 0;  // DICT_4X4_50
}

std::string Millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g mm", 1e3 * metres);
  return text;
}

}  // namespace

std::vector<TargetMarker> MarkersOf(const Target& target) {
  std::vector<TargetMarker> markers;
  const double pitch = target.pitch_m;
  int next = target.first_id;
  for (int row = 0; row < target.rows; ++row)
    for (int column = 0; column < target.columns; ++column) {
      if (target.kind == TargetKind::kTagMosaic) {
        markers.push_back(
            {target.first_id + target.stride * row + column,
             Square(pitch * column, pitch * row, MosaicTagSide(target, MarkerCells(target)), 1)});
      } else if (target.kind == TargetKind::kAprilGrid) {
        const double step = pitch * (1 + target.spacing);
        markers.push_back({next++, Square(step * column, step * row + pitch, pitch, -1)});
      } else if (target.kind == TargetKind::kCharuco && !IsBlackSquare(target, column, row)) {
        const double margin = (pitch - target.marker_m) / 2;
        // The first inner corner is the origin.
        markers.push_back({next++, Square(pitch * (column - 1) + margin, pitch * (row - 1) + margin,
                                          target.marker_m, 1)});
      }
    }
  return markers;
}

Target AprilCalMosaic(int columns, int rows, double pitch_m) {
  Target target;
  target.kind = TargetKind::kTagMosaic;
  target.columns = columns;
  target.rows = rows;
  target.pitch_m = pitch_m;
  target.family = "tag36h11";
  return target;
}

std::vector<TargetCorner> CornersOf(const Target& target) {
  std::vector<TargetCorner> corners;
  if (target.kind == TargetKind::kChessboard || target.kind == TargetKind::kCharuco) {
    const bool is_charuco = target.kind == TargetKind::kCharuco;
    const int columns = target.columns - is_charuco, rows = target.rows - is_charuco;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        // The square at larger x and y; of a chessboard the first is black, as the one before it.
        const bool is_black =
            is_charuco ? IsBlackSquare(target, column + 1, row + 1) : (column + row) % 2 == 0;
        corners.push_back({row * columns + column,
                           {target.pitch_m * column, target.pitch_m * row, 0},
                           is_black ? 1 : -1});
      }
    return corners;
  }
  for (const TargetMarker& marker : MarkersOf(target)) {
    if (target.kind == TargetKind::kTagMosaic) {
      for (std::size_t k = 0; k < 4; ++k)
        corners.push_back({4 * marker.id + static_cast<int>(k),
                           {marker.corners[k][0], marker.corners[k][1], 0},
                           0});
    } else {
      // Kalibr: from the lower left anticlockwise.  The tag itself is black at larger x and y of
      // its lower left corner.
      constexpr std::size_t kOrder[4] = {3, 2, 1, 0};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto& place = marker.corners[kOrder[k]];
        corners.push_back(
            {4 * marker.id + static_cast<int>(k), {place[0], place[1], 0}, k % 2 == 0 ? 1 : -1});
      }
    }
  }
  return corners;
}

std::vector<TargetSquare> BlackOf(const Target& target) {
  std::vector<TargetSquare> squares;
  const double pitch = target.pitch_m;
  const double up = HasYUp(target) ? -1 : 1;
  if (target.kind == TargetKind::kChessboard || target.kind == TargetKind::kCharuco) {
    const int extra = target.kind == TargetKind::kChessboard;
    for (int row = 0; row < target.rows + extra; ++row)
      for (int column = 0; column < target.columns + extra; ++column) {
        const bool is_black = extra ? (column + row) % 2 == 0 : IsBlackSquare(target, column, row);
        if (is_black) squares.push_back({pitch * (column - 1), pitch * (row - 1), pitch, pitch});
      }
  }
  if (target.kind == TargetKind::kAprilGrid) {
    const double gap = pitch * target.spacing, step = pitch + gap;
    for (int row = 0; row <= target.rows; ++row)
      for (int column = 0; column <= target.columns; ++column)
        squares.push_back({step * column - gap, step * row - gap, gap, gap});
  }
  if (!HasMarkers(target)) return squares;
  const MarkerFamily family = MarkerFamilyOf(target.family);
  const int across = family.cells + 2 * target.border_cells;
  for (const TargetMarker& marker : MarkersOf(target)) {
    const auto& corner = marker.corners[0];
    const double cell = (marker.corners[1][0] - corner[0]) / across;
    const std::vector<std::uint8_t>& code = family.codes[static_cast<std::size_t>(marker.id)];
    const auto is_white = [&](int x, int y) {
      const int i = x - target.border_cells, k = y - target.border_cells;
      return i >= 0 && k >= 0 && i < family.cells && k < family.cells &&
             code[static_cast<std::size_t>(k * family.cells + i)] != 0;
    };
    // A run of black cells is one rectangle: no seams where a printer rounds.
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x) {
        if (is_white(x, y)) continue;
        int end = x;
        while (end < across && !is_white(end, y)) ++end;
        const double top = corner[1] + up * cell * (y + (up < 0 ? 1 : 0));
        squares.push_back({corner[0] + cell * x, top, cell * (end - x), cell});
        x = end;
      }
  }
  return squares;
}

std::array<double, 4> ExtentOf(const Target& target) {
  std::array<double, 4> box = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  const auto include = [&box](double x, double y) {
    box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
  };
  double white = target.pitch_m / 2;
  if (target.kind == TargetKind::kChessboard || target.kind == TargetKind::kCharuco) {
    const int extra = target.kind == TargetKind::kChessboard;
    include(-target.pitch_m, -target.pitch_m);
    include(target.pitch_m * (target.columns + extra - 1),
            target.pitch_m * (target.rows + extra - 1));
  } else {
    for (const TargetMarker& marker : MarkersOf(target))
      for (const auto& corner : marker.corners) include(corner[0], corner[1]);
    white = target.kind == TargetKind::kAprilGrid ? 2 * target.spacing * target.pitch_m
                                                  : 0.2 * target.pitch_m;
  }
  return {box[0] - white, box[1] - white, box[2] + white, box[3] + white};
}

void CheckTarget(const Target& target) {
  const auto refuse = [](const std::string& why) {
    throw Error("target: " + why, ErrorKind::kUsage);
  };
  constexpr int kMostASide = 200;
  const bool is_board =
      target.kind == TargetKind::kChessboard || target.kind == TargetKind::kCharuco;
  const int least = is_board ? 2 : 1;
  if (target.columns < least || target.rows < least || target.columns > kMostASide ||
      target.rows > kMostASide)
    refuse("expected " + std::to_string(least) + " to 200 columns and rows, found " +
           std::to_string(target.columns) + " and " + std::to_string(target.rows));
  if (!(target.pitch_m > 0) || !std::isfinite(target.pitch_m)) refuse("expected a size above zero");
  if (!HasMarkers(target)) return;
  const MarkerFamily family = MarkerFamilyOf(target.family);
  if (target.border_cells < 1 || target.border_cells > 2)
    refuse("expected a black border of 1 or 2 cells");
  if (target.kind == TargetKind::kAprilGrid && !(target.spacing > 0 && target.spacing <= 1))
    refuse("expected a spacing above 0, at most 1, of a tag's side");
  if (target.kind == TargetKind::kCharuco &&
      !(target.marker_m > 0 && target.marker_m < target.pitch_m))
    refuse("expected markers that are smaller than the squares");
  if (target.kind == TargetKind::kTagMosaic && target.columns > target.stride)
    refuse("expected at most " + std::to_string(target.stride) +
           " columns of a mosaic: a tag's id is that many times the row, and the column");
  const std::vector<TargetMarker> markers = MarkersOf(target);
  if (target.first_id < 0 || (!markers.empty() && markers.back().id >= family.markers))
    refuse(family.name + " has " + std::to_string(family.markers) +
           " markers, the last here would be " + std::to_string(markers.back().id));
}

std::string Described(const Target& target) {
  const std::string grid = std::to_string(target.columns) + " x " + std::to_string(target.rows);
  switch (target.kind) {
    case TargetKind::kChessboard:
      return "chessboard of " + grid + " corners, squares of " + Millimetres(target.pitch_m);
    case TargetKind::kCharuco:
      return std::string("ChArUco board of ") + grid + " squares of " +
             Millimetres(target.pitch_m) + ", " + target.family + " markers of " +
             Millimetres(target.marker_m) + (target.is_legacy ? ", legacy pattern" : "");
    case TargetKind::kAprilGrid:
      return "aprilgrid of " + grid + " " + target.family + " tags of " +
             Millimetres(target.pitch_m) + ", " + Millimetres(target.pitch_m * target.spacing) +
             " apart";
    case TargetKind::kTagMosaic:
      return "mosaic of " + grid + " " + target.family + " tags, " + Millimetres(target.pitch_m) +
             " from one to the next";
  }
  return "";
}

}  // namespace graticule
