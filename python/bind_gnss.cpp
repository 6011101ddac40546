#include <map>

#include "bind.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/gnss.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/problems/mapping/gnss_alignment.hpp"
#include "graticule/problems/mapping/gnss_factors.hpp"
#include "graticule/problems/mapping/simulate_gnss.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

std::array<double, 3> NumbersOf(const Geodetic& place) {
  return {place.latitude, place.longitude, place.height};
}

// Where the robots were at every scan of the log.
RobotTracks TracksOf(const Mission& mission, const Dense<double>& world_from_scan) {
  const std::vector<LaserScan>& scans = mission.log.scans;
  ExpectShape(world_from_scan, {static_cast<py::ssize_t>(scans.size()), 3}, "world_from_scan");
  RobotTracks tracks(mission.log.robots.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const double* row = world_from_scan.data(static_cast<py::ssize_t>(i));
    tracks[scans[i].robot].push_back({scans[i].time, {row[0], row[1], row[2]}});
  }
  return tracks;
}

void BindPlaces(py::module_& m) {
  Record<Geodetic>(m, "Geodetic", "A place on the Earth, WGS 84.")
      .Field("latitude", &Geodetic::latitude, "[degrees]")
      .Field("longitude", &Geodetic::longitude, "[degrees]")
      .Field("height", &Geodetic::height, "Above the ellipsoid [m].");
  m.def(
      "geodetic_of",
      [](const Geodetic& datum, const Dense<double>& points) {
        ExpectShape(points, {-1, 2}, "points");
        std::vector<double> places;
        for (py::ssize_t i = 0; i < points.shape(0); ++i)
          for (const double number : NumbersOf(GeodeticOf(datum, points.at(i, 0), points.at(i, 1))))
            places.push_back(number);
        return Owned(std::move(places), {points.shape(0), 3});
      },
      "datum"_a, "points"_a,
      "(n, 2) points of a map whose origin is the datum, x east and y north [m], on the Earth: "
      "(n, 3) latitude, longitude [degrees], height [m].  Transverse Mercator (Karney 2011).");
  m.def(
      "map_points_of",
      [](const Geodetic& datum, const Dense<double>& places) {
        ExpectShape(places, {-1, 3}, "places");
        std::vector<double> points(2 * static_cast<std::size_t>(places.shape(0)));
        for (py::ssize_t i = 0; i < places.shape(0); ++i) {
          double* point = points.data() + 2 * i;
          MapPointOf(datum, {places.at(i, 0), places.at(i, 1), places.at(i, 2)}, point, point + 1);
        }
        return Owned(std::move(points), {places.shape(0), 2});
      },
      "datum"_a, "places"_a, "And back: (n, 3) to (n, 2).");
  m.def(
      "geodetic_se2_factor",
      [](const Key& pose, const Geodetic& antenna, const Geodetic& datum,
         const std::array<double, 2>& lever, const Noise& noise, const std::string& source) {
        return GeodeticSe2Factor(pose, NumbersOf(antenna), NumbersOf(datum), lever, noise, source);
      },
      "pose"_a, "antenna"_a, "datum"_a, "lever_in_body"_a, "noise"_a, "source"_a = "gnss",
      "An antenna is there on the Earth; the graph's world lies at the datum, x east.  Its lever "
      "[m, in the body: ahead, to the left]; noise to the east and north [m].");
}

void BindFixes(py::module_& m) {
  Record<GnssFix>(m, "GnssFix", "Where a satellite receiver says that its antenna was.")
      .Field("time", &GnssFix::time, "By the clock of the robot's log [s].")
      .Field("robot", &GnssFix::robot, "Its name in the log.")
      .Field("antenna", &GnssFix::antenna, "The place.")
      .Field("sigma_m", &GnssFix::sigma_m, "Standard deviation, to the east and north [m].");
  m.def(
      "read_gnss", [](const std::string& path) { return ParseGnss(ReadFile(path), path); },
      "path"_a, "Lines `time,robot,latitude,longitude,height,sigma` (s, degrees, m).");
  m.def(
      "write_gnss",
      [](const std::string& path, const std::vector<GnssFix>& fixes) {
        WriteFile(path, FormatGnss(fixes));
      },
      "path"_a, "fixes"_a, "The same lines, which read back to the bit.");
  m.def("simulate_gnss", &SimulateGnss, "simulated"_a, "datum"_a, "every_s"_a = 5.0,
        "sigma_m"_a = 1.0, "bad"_a = 0, "seed"_a = 1,
        "What a receiver on each robot's centre would have said during a mission: a fix every "
        "`every_s`, `bad` of them 50 m off.  Same seed, same digits.");

  Record<GnssOptions>(m, "GnssOptions", "How fixes are laid onto a mission.")
      .Field("datum", &GnssOptions::datum, "The origin; None: the first fix that is used.")
      .Field("antenna_x", &GnssOptions::antenna_x, "On the robot, ahead [m].")
      .Field("antenna_y", &GnssOptions::antenna_y, "On the robot, to the left [m].")
      .Field("loss", &GnssOptions::loss, "Deviations from where on a fix counts less (Cauchy).")
      .Field("solve", &GnssOptions::solve, "Of the graph.");
  Record<GnssReport>(m, "GnssReport", "What became of the fixes.")
      .Result("used", &GnssReport::used, "Fixes.")
      .Result("outside", &GnssReport::outside, "Of times when the robot's log says nothing.")
      .Result("off", &GnssReport::off, "Used, but more than five deviations from the solution.")
      .Result("rms_m", &GnssReport::rms_m, "Of the others [m].")
      .Result("sigma_yaw_rad", &GnssReport::sigma_yaw_rad,
              "Of the map's direction before the solve [rad].")
      .Result("without", &GnssReport::without, "Robots whose piece of the graph has no fix.");
  m.def(
      "add_gnss",
      [](Mission& mission, const std::vector<GnssFix>& fixes,
         const std::optional<Dense<double>>& world_from_scan, const std::string& name,
         const GnssOptions* options, const py::kwargs& keywords) {
        const GnssOptions chosen = OptionsFrom(options, keywords);
        RobotTracks tracks =
            world_from_scan ? TracksOf(mission, *world_from_scan) : TracksOfNodes(mission);
        const py::gil_scoped_release released;
        return AddGnss(fixes, name, std::move(tracks), chosen, &mission);
      },
      "mission"_a, "fixes"_a, "world_from_scan"_a = py::none(), "name"_a = "fixes",
      "options"_a = nullptr,
      "Makes a mission's graph, which is solved, one of a world that is east and north of a datum: "
      "each piece is laid onto its fixes, a factor `geodetic_se2/1` added for each, and the graph "
      "solved.  The mission is changed.  world_from_scan: (scans, 3) poses at every scan of the "
      "log, as FrontEndResult has them; None: those of the nodes.  `name` is for errors.  Options "
      "also as keywords.");
}

void BindAlignment(py::module_& m) {
  py::class_<GroundAlignment>(m, "GroundAlignment", "Where a map lies on the ground.")
      .def_readonly("ground_from_map", &GroundAlignment::ground_from_map, "(3,) x m, y m, yaw rad.")
      .def_readonly("sigma_yaw", &GroundAlignment::sigma_yaw, "[rad]")
      .def_readonly("sigma", &GroundAlignment::sigma, "At the middle of the points [m].")
      .def_readonly("agreeing", &GroundAlignment::agreeing, "Points within three deviations.");
  m.def(
      "align_to_ground",
      [](const Dense<double>& in_map, const Dense<double>& on_ground, double sigma) {
        ExpectShape(in_map, {-1, 2}, "in_map");
        ExpectShape(on_ground, {in_map.shape(0), 2}, "on_ground");
        std::vector<GroundPoint> points;
        for (py::ssize_t i = 0; i < in_map.shape(0); ++i)
          points.push_back(
              {in_map.at(i, 0), in_map.at(i, 1), on_ground.at(i, 0), on_ground.at(i, 1), sigma});
        return AlignToGround(points);
      },
      "in_map"_a, "on_ground"_a, "sigma"_a = 1.0,
      "Lays a map onto the ground: (n, 2) points of the map [m], (n, 2) east and north of them "
      "[m], each known to `sigma` [m].  Up to half of the points may lie anywhere.");
}

}  // namespace

void BindGeography(py::module_& module) { BindPlaces(module); }

void BindGnss(py::module_& module) {
  BindFixes(module);
  BindAlignment(module);
}

}  // namespace graticule::python
