#include "graticule/problems/mapping/georeference.hpp"

#include <GeographicLib/TransverseMercator.hpp>
#include <charconv>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Scale 1 on the meridian, at the ellipsoid.
const GeographicLib::TransverseMercator& Mercator() {
  static const GeographicLib::TransverseMercator mercator(6378137.0, 1 / 298.257223563, 1.0);
  return mercator;
}

double NorthingOf(const Geodetic& datum) {
  double x = 0, y = 0;
  Mercator().Forward(datum.longitude, datum.latitude, datum.longitude, x, y);
  return y;
}

}  // namespace

Geodetic ParseDatum(std::string_view text) {
  const auto refuse = [&](const std::string& why) {
    throw Error("the datum '" + std::string(text) + "': " + why, ErrorKind::kUsage);
  };
  double numbers[3] = {};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  int count = 0;
  while (count < 3) {
    const auto [next, error] = std::from_chars(at, end, numbers[count]);
    if (error != std::errc() || !std::isfinite(numbers[count]))
      refuse("expected LAT,LON or LAT,LON,HEIGHT, in degrees and metres");
    ++count;
    at = next;
    if (at == end || *at != ',') break;
    ++at;
  }
  if (at != end || count < 2) refuse("expected LAT,LON or LAT,LON,HEIGHT, in degrees and metres");
  // At the poles east is everywhere.
  if (std::abs(numbers[0]) > 89.9) refuse("expected a latitude in -89.9 to 89.9 degrees");
  if (std::abs(numbers[1]) > 180) refuse("expected a longitude in -180 to 180 degrees");
  return {numbers[0], numbers[1], numbers[2]};
}

Geodetic GeodeticOf(const Geodetic& datum, double x, double y) {
  Geodetic place;
  const double scale = ScaleOfHeight(datum);
  Mercator().Reverse(datum.longitude, x / scale, y / scale + NorthingOf(datum), place.latitude,
                     place.longitude);
  place.height = datum.height;
  return place;
}

void MapPointOf(const Geodetic& datum, const Geodetic& place, double* x, double* y) {
  Mercator().Forward(datum.longitude, place.latitude, place.longitude, *x, *y);
  const double scale = ScaleOfHeight(datum);
  *x *= scale;
  *y = (*y - NorthingOf(datum)) * scale;
}

}  // namespace graticule
