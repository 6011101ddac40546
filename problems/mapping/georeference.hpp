#pragma once

#include <string_view>

#include "graticule/io/geography.hpp"
#include "graticule/io/planar_pose.hpp"

namespace graticule {

/// "LAT,LON" or "LAT,LON,HEIGHT", in degrees and metres.  Throws Error (kUsage) where it is not
/// that, or no such place exists.
Geodetic ParseDatum(std::string_view text);

/// A point of the map (m; x east, y north, the datum at its origin) on the Earth: by the transverse
/// Mercator projection about the datum (Karney 2011), in metres at its height, the coordinates of
/// FormatProjection.  Within 5 km this is the plane that touches the Earth at the datum (east and
/// north of EastNorthUp) to 5 mm.
Geodetic GeodeticOf(const Geodetic& datum, double x, double y);

/// And back.
void MapPointOf(const Geodetic& datum, const Geodetic& place, double* x, double* y);

}  // namespace graticule
