#pragma once

// Internal to the guess of a target: how markers lie to each other, and which target that is.

#include <vector>

#include "graticule/problems/calibration/marker_detector.hpp"
#include "graticule/problems/calibration/target.hpp"

namespace graticule {

/// Where one marker is, as seen from another: in the sides of that one, x right and y down as it is
/// printed.
struct MarkerPair {
  int from = 0, to = 0;
  double x = 0, y = 0;
  double gap = 0;  ///< between the two, in their sides, of one beside another; else 0
};

/// Markers near each other in one image that see each other at the same way there and back.
std::vector<MarkerPair> PairsOf(const std::vector<SeenMarker>& markers);

/// A target, and how many pairs lie as it says.
struct LayoutGuess {
  Target target;
  std::size_t fitting = 0;
};

/// Tags in rows: with a border of two cells Kalibr's grid, else a mosaic.  No pair fits the guess
/// where there is none.
LayoutGuess GuessTagLayout(const std::vector<MarkerPair>& pairs, const MarkerFamily& family,
                           int border_cells);

/// Markers in the white squares of a chessboard.
LayoutGuess GuessCharucoLayout(const std::vector<MarkerPair>& pairs, const MarkerFamily& family);

}  // namespace graticule
