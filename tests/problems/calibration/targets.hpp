#pragma once

#include <vector>

#include "graticule/problems/calibration/target.hpp"

namespace graticule::test {

/// Small targets: a mosaic, a grid, a ChArUco board (and a legacy one), a chessboard.
inline std::vector<Target> OneOfEachKind() {
  Target mosaic;
  mosaic.kind = TargetKind::kTagMosaic;
  mosaic.columns = 4;
  mosaic.rows = 3;
  mosaic.pitch_m = 0.0381;
  mosaic.family = "tag36h11";
  Target grid = mosaic;
  grid.kind = TargetKind::kAprilGrid;
  grid.pitch_m = 0.03;
  grid.border_cells = 2;
  Target charuco;
  charuco.kind = TargetKind::kCharuco;
  charuco.columns = 6;
  charuco.rows = 4;
  charuco.pitch_m = 0.03;
  charuco.marker_m = 0.0225;
  charuco.family = "DICT_5X5_50";
  Target legacy = charuco;
  legacy.is_legacy = true;
  Target chessboard;
  chessboard.kind = TargetKind::kChessboard;
  chessboard.columns = 7;
  chessboard.rows = 4;
  chessboard.pitch_m = 0.03;
  return {mosaic, grid, charuco, legacy, chessboard};
}

}  // namespace graticule::test
