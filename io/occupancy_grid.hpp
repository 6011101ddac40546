#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace graticule {

enum class CellLabel : std::uint8_t { kUnknown, kFree, kStructure };

/// A box of cells of a lattice that is fixed to the world: cell (x, y) covers
/// [x, x + 1) * resolution in x, and so in y.
struct CellBox {
  std::int32_t left = 0, bottom = 0;  ///< the lower left cell
  std::int32_t width = 0, height = 0;
  bool Has(std::int32_t x, std::int32_t y) const {
    return x >= left && y >= bottom && x - left < width && y - bottom < height;
  }
};

/// A ternary map as a plain array, for files and pictures.
struct OccupancyGrid {
  double resolution = 0;  ///< m, a cell's side
  CellBox box;
  std::vector<CellLabel> cells;  ///< row by row from the bottom, each from the left

  double OriginX() const { return box.left * resolution; }  ///< m: the lower left corner
  double OriginY() const { return box.bottom * resolution; }
  CellLabel At(std::int32_t column, std::int32_t row) const {
    return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(box.width) +
                 static_cast<std::size_t>(column)];
  }
};

}  // namespace graticule
