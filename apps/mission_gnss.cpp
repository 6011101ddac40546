#include "mission_gnss.hpp"

#include <fmt/core.h>

#include <cmath>

#include "graticule/io/file.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/solver/error.hpp"
#include "numbers.hpp"

namespace graticule::apps {

void Georeference(const MapCommand& command, const std::vector<GnssFix>& of_logs,
                  RobotTracks tracks, Mission* mission, MapReport* report) {
  GnssOptions options;
  if (!command.datum.empty()) options.datum = ParseDatum(command.datum);
  if (!command.antenna.empty()) {
    const std::vector<double> place =
        ReadNumbers("--antenna", command.antenna, 2, "X,Y, in metres");
    options.antenna_x = place[0];
    options.antenna_y = place[1];
  }
  const bool in_log = command.gnss == "log";
  if (in_log && of_logs.empty())
    throw Error("--gnss log: no log has an NMEAGGA message with a fix");
  const GnssReport did =
      AddGnss(in_log ? of_logs : ParseGnss(ReadFile(command.gnss), command.gnss),
              in_log ? "NMEAGGA" : command.gnss, std::move(tracks), options, mission);
  report->facts.emplace_back(
      "gnss",
      fmt::format("{} fixes, {} of them more than five deviations off; the others within "
                  "{:.2f} m (rms); east is known to {:.2f} degrees",
                  ReadableCount(did.used), did.off, did.rms_m, did.sigma_yaw_rad * 180 / M_PI));
  report->facts.emplace_back("datum",
                             fmt::format("{:.8f}, {:.8f}, {:.2f} m", mission->datum->latitude,
                                         mission->datum->longitude, mission->datum->height));
  if (did.outside > 0)
    report->warnings.push_back(
        fmt::format("{} fixes are of times when their robots' logs have no scan", did.outside));
  for (const std::string& robot : did.without)
    report->warnings.push_back(robot +
                               " has no fix, and is joined to none that has: it lies on the "
                               "map by chance");
}

}  // namespace graticule::apps
