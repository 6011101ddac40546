#pragma once

// Internal to detection: plain chessboards by OpenCV.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "graticule/io/grey_image.hpp"

namespace graticule {

/// A chessboard's inner corners, row by row.
struct SeenChessboard {
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector2d> corners;
};

/// All corners of a board of this size, to a pixel or two, or none.  `thorough` tries the slow
/// detector where the quick one finds none.  Corner 0 has a black square at larger x and y; where
/// two ends do, it is the one nearer to the upper left of the image.
std::optional<SeenChessboard> FindChessboard(const GreyImage& image, int columns, int rows,
                                             bool thorough);

/// The largest board of unknown size, columns >= rows.
std::optional<SeenChessboard> FindAnyChessboard(const GreyImage& image);

}  // namespace graticule
