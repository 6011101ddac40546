#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/problems/attenuation/simulate_materials.hpp"

namespace graticule {

/// What kind of place, and how large.
struct PlaceOptions {
  enum class Kind { kRoom, kHouse, kOffice, kLibrary, kStreet };
  std::string name = "office";
  Kind kind = Kind::kOffice;
  double width_m = 40, height_m = 25;
  double duration_s = 300;  ///< of its exploration
  std::uint64_t seed = 1;
};

/// The places that there are by name: those of the thesis' section 3.3.1 in kind and size (nw1, nw2
/// between apartment houses; bbb3, eecs4 floors of offices; dc1 a library), and smaller ones for
/// trying things out: room, house, office, street.
const std::vector<PlaceOptions>& KnownPlaces();
/// Throws Error (kUsage): no such place.
PlaceOptions PlaceByName(const std::string& name);

/// What is where, cell by cell.
struct FloorPlan {
  double resolution = 0.1;  ///< m; the outer corner of cell (0, 0) is the map's origin
  std::size_t width = 0, height = 0;
  std::vector<Filling> cells;  ///< row by row, the lowest first
  /// Of the path loss in sight (3GPP TR 38.901, table 7.4.1-1): InH-Office, or UMi-Street Canyon.
  double exponent = kIndoorExponent;
  static constexpr double kIndoorExponent = 1.73, kStreetExponent = 2.1;

  Filling At(std::size_t x, std::size_t y) const { return cells[y * width + x]; }
  /// Structure or free, of every cell.
  OccupancyGrid Occupied() const;
};

/// Same options, same plan.  Throws Error (kUsage): smaller than 4 m a side, more than 2^28 cells.
FloorPlan MakeFloorPlan(const PlaceOptions& options);

}  // namespace graticule
