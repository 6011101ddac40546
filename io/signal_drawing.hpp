#pragma once

#include <string>
#include <vector>

#include "graticule/io/occupancy.hpp"

namespace graticule {

/// Numbers over the plane, to be laid over a map.
struct HeatField {
  std::string title, unit;
  double left_m = 0, bottom_m = 0, step_m = 1;  ///< in the map's frame
  std::size_t width = 0, height = 0;            ///< steps
  std::vector<double> values;                   ///< row by row, the lowest first; nan: none
  bool low_is_good = false;                     ///< attenuation: orange is low
};

/// A place with a name.
struct HeatMark {
  double x_m = 0, y_m = 0;
  std::string name;
};

/// Fields one below the other, each with its colour bar: orange and white where signals pass, blue
/// where they are weak or weakened, the map's structure black over it (as the thesis' Figure 3.1).
/// Without a map the fields alone.  Returns an SVG document.
std::string DrawHeat(const std::vector<HeatField>& fields, const OccupancyGrid* map,
                     const std::vector<HeatMark>& marks);

}  // namespace graticule
