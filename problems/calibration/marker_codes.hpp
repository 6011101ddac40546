#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/solver/span.hpp"

namespace graticule {

/// A family of square markers that carry a number, by AprilTag's names (tag36h11) or OpenCV's
/// (DICT_4X4_50).  A marker is a black border around a square of cells.
struct MarkerFamily {
  std::string name;
  int cells = 0;    ///< a side, without the border
  int markers = 0;  ///< how many there are
  /// Of each marker, cell by cell from its upper left: 1 is white.
  std::vector<std::vector<std::uint8_t>> codes;
  int correctable = 0;  ///< wrong cells that still leave no doubt, at most 2
};

/// tag16h5, tag25h9, tag36h10, tag36h11, DICT_4X4_50, 100, 250, and alike 5X5, 6X6, 7X7.
std::vector<std::string> MarkerFamilyNames();

/// Throws Error (kUsage) that lists them.
MarkerFamily MarkerFamilyOf(std::string_view name);

/// Codes of OpenCV's dictionaries of 4 to 7 cells a side, row by row from the most significant bit.
Span<const std::uint64_t> ArucoCodes(int bits_a_side);

}  // namespace graticule
