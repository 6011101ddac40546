#pragma once

#include <string>
#include <vector>

#include "graticule/io/occupancy.hpp"

namespace graticule {

/// A place on the Earth, WGS 84.
struct Geodetic {
  double latitude = 0, longitude = 0;  ///< degrees
  double height = 0;                   ///< m, above the ellipsoid
};

/// A named line over the Earth.
struct GeographicLine {
  std::string name;
  std::vector<Geodetic> points;
};

/// Lines on the ground, for Google Earth and others.
std::string FormatKml(const std::vector<GeographicLine>& lines, const std::string& title);
/// RFC 7946: a feature a line, longitude first.
std::string FormatGeoJson(const std::vector<GeographicLine>& lines);

/// The world file of a grid's picture, whose top row comes first: six lines, the steps of a pixel
/// to the right and down, and the centre of its upper left pixel, in metres of the map's frame.
std::string FormatWorldFile(const OccupancyGrid& grid);

/// The coordinates that a world file is in, as ESRI's WKT: transverse Mercator about `origin`,
/// metres at its height to the east and north.
std::string FormatProjection(const Geodetic& origin);

/// By how much metres at a place's height are fewer than those on the ellipsoid below: 1 + height /
/// sqrt(M N), with the radii of curvature of the ellipsoid there.
double ScaleOfHeight(const Geodetic& place);

}  // namespace graticule
