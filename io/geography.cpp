#include "graticule/io/geography.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/io/json_text.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/io/text.hpp"

namespace graticule {

std::string FormatKml(const std::vector<GeographicLine>& lines, const std::string& title) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n"
      "<Document>\n<name>" +
      EscapeXml(title) + "</name>\n";
  for (const GeographicLine& line : lines) {
    text += "<Placemark><name>" + EscapeXml(line.name) +
            "</name><LineString><tessellate>1</tessellate><coordinates>\n";
    for (const Geodetic& point : line.points) {
      AppendNumber(&text, point.longitude);
      text += ',';
      AppendNumber(&text, point.latitude);
      text += '\n';
    }
    text += "</coordinates></LineString></Placemark>\n";
  }
  return text + "</Document>\n</kml>\n";
}

std::string FormatGeoJson(const std::vector<GeographicLine>& lines) {
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  for (const GeographicLine& line : lines) {
    nlohmann::ordered_json coordinates = nlohmann::ordered_json::array();
    for (const Geodetic& point : line.points)
      coordinates.push_back({point.longitude, point.latitude, point.height});
    features.push_back({{"type", "Feature"},
                        {"properties", {{"name", line.name}}},
                        {"geometry", {{"type", "LineString"}, {"coordinates", coordinates}}}});
  }
  return JsonText(nlohmann::ordered_json{{"type", "FeatureCollection"}, {"features", features}}) +
         "\n";
}

std::string FormatWorldFile(const OccupancyGrid& grid) {
  const double c = grid.resolution * std::cos(grid.map_from_grid.yaw);
  const double s = grid.resolution * std::sin(grid.map_from_grid.yaw);
  double x = 0, y = 0;
  grid.map_from_grid.Transform(0.5 * grid.resolution,
                               (static_cast<double>(grid.height) - 0.5) * grid.resolution, &x, &y);
  std::string text;
  // To the right: (c, s).  Down, for the rows begin at the top: (s, -c).
  for (const double number : {c, s, s, -c, x, y}) {
    AppendNumber(&text, number);
    text += '\n';
  }
  return text;
}

double ScaleOfHeight(const Geodetic& place) {
  constexpr double kRadius = 6378137, kFlattening = 1 / 298.257223563;
  constexpr double kE2 = kFlattening * (2 - kFlattening);
  const double s = std::sin(place.latitude * M_PI / 180);
  return 1 + place.height * (1 - kE2 * s * s) / (kRadius * std::sqrt(1 - kE2));
}

std::string FormatProjection(const Geodetic& origin) {
  std::string text =
      "PROJCS[\"Local_Transverse_Mercator\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\","
      "SPHEROID[\"WGS_1984\",6378137.0,298.257223563]],PRIMEM[\"Greenwich\",0.0],"
      "UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],"
      "PARAMETER[\"False_Easting\",0.0],PARAMETER[\"False_Northing\",0.0],"
      "PARAMETER[\"Central_Meridian\",";
  AppendNumber(&text, origin.longitude);
  text += "],PARAMETER[\"Scale_Factor\",";
  AppendNumber(&text, ScaleOfHeight(origin));
  text += "],PARAMETER[\"Latitude_Of_Origin\",";
  AppendNumber(&text, origin.latitude);
  return text + "],UNIT[\"Meter\",1.0]]\n";
}

}  // namespace graticule
