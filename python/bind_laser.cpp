#include "bind.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/geography.hpp"
#include "graticule/io/occupancy.hpp"
#include "graticule/io/relations.hpp"
#include "poses.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

py::array_t<double> OdometryOf(const LaserLog& log) {
  std::vector<PlanarPose> poses;
  for (const LaserScan& scan : log.scans) poses.push_back(scan.odom_from_robot);
  return RowsOf(poses);
}

LaserLog LogOf(const Dense<float>& ranges, const Dense<double>& times,
               const Dense<double>& odometry, const LaserGeometry& geometry,
               const std::string& robot) {
  ExpectShape(ranges, {-1, -1}, "ranges");
  const py::ssize_t count = ranges.shape(0), beams = ranges.shape(1);
  ExpectShape(times, {count}, "times");
  ExpectShape(odometry, {count, 3}, "odometry");
  LaserLog log;
  log.robots = {robot};
  log.geometries = {geometry};
  log.ranges.assign(ranges.data(), ranges.data() + ranges.size());
  for (py::ssize_t i = 0; i < count; ++i) {
    LaserScan scan;
    scan.time = times.at(i);
    scan.odom_from_robot = {odometry.at(i, 0), odometry.at(i, 1), odometry.at(i, 2)};
    scan.first_range = static_cast<std::size_t>(i * beams);
    scan.beams = static_cast<std::uint32_t>(beams);
    log.scans.push_back(scan);
  }
  return log;
}

void BindLogs(py::module_& m) {
  Record<LaserGeometry>(m, "LaserGeometry",
                        "How the beams of a planar laser lie, and where it sits on its robot.")
      .Field("first_angle", &LaserGeometry::first_angle,
             "Of the first beam, in the laser's frame: x ahead, y left [rad].")
      .Field("step", &LaserGeometry::step, "From one beam to the next [rad].")
      .Field("max_range", &LaserGeometry::max_range, "A reading from there on saw nothing [m].")
      .Field("robot_from_laser", &LaserGeometry::robot_from_laser, "[x m, y m, yaw rad].");
  py::class_<LaserLog, std::shared_ptr<LaserLog>>(
      m, "LaserLog", "Recorded sweeps of one or several robots, each robot's in their order.")
      .def(py::init(&LogOf), "ranges"_a, "times"_a, "odometry"_a, "geometry"_a,
           "robot"_a = "robot1",
           "Of one robot.  ranges: (scans, beams) [m]; times: (scans,) [s]; odometry: (scans, 3) "
           "odom_from_robot [m, m, rad].")
      .def_readonly("robots", &LaserLog::robots, "Names: key families of their poses.")
      .def_readonly("geometries", &LaserLog::geometries, "Of the lasers.")
      .def("__len__", [](const LaserLog& log) { return log.scans.size(); })
      .def_property_readonly(
          "times",
          [](const LaserLog& log) {
            std::vector<double> times;
            for (const LaserScan& scan : log.scans) times.push_back(scan.time);
            return times;
          },
          "(scans,) [s].")
      .def_property_readonly(
          "robot_of_scan",
          [](const LaserLog& log) {
            std::vector<std::uint32_t> robots;
            for (const LaserScan& scan : log.scans) robots.push_back(scan.robot);
            return robots;
          },
          "(scans,) into `robots`.")
      .def_property_readonly("odometry", &OdometryOf,
                             "(scans, 3) odom_from_robot: x m, y m, yaw rad.")
      .def_property_readonly(
          "ranges",
          [](py::object self) {
            const auto& log = self.cast<const LaserLog&>();
            return View(log.ranges.data(), {static_cast<py::ssize_t>(log.ranges.size())}, self,
                        false);
          },
          "All readings [m], one sweep after the other.  Not a copy; it cannot be written to.")
      .def(
          "ranges_of",
          [](py::object self, std::size_t scan) {
            const auto& log = self.cast<const LaserLog&>();
            if (scan >= log.scans.size())
              throw Error("there is no scan " + std::to_string(scan), ErrorKind::kUsage);
            const Span<const float> ranges = log.RangesOf(log.scans[scan]);
            return View(ranges.data(), {static_cast<py::ssize_t>(ranges.size())}, self, false);
          },
          "scan"_a, "(beams,) readings of a sweep [m].  Not a copy; it cannot be written to.")
      .def("__repr__", [](const LaserLog& log) {
        return "LaserLog(" + std::to_string(log.robots.size()) + " robots, " +
               std::to_string(log.scans.size()) + " scans)";
      });
}

void BindCarmen(py::module_& m) {
  Record<CarmenOptions>(m, "CarmenOptions", "How CARMEN's logs are read.")
      .Field("robot", &CarmenOptions::robot, "Key family; \"\": robot1, robot2, ...")
      .Field("laser", &CarmenOptions::laser, "\"FLASER\", ...; \"\": what the log has.")
      .Field("laser_offset", &CarmenOptions::laser_offset,
             "robot_from_laser [m, m, rad]; None: as the log says.")
      .Field("read_fixes", &CarmenOptions::read_fixes, "Reads NMEAGGA messages.")
      .Field("time_jitter", &CarmenOptions::time_jitter,
             "A scan may seem to be this much earlier than those before [s].")
      .Field("skip_bad", &CarmenOptions::skip_bad, "Lines that are wrong are passed over.");
  m.def(
      "read_carmen",
      [](const std::string& path, const CarmenOptions* options, const py::kwargs& keywords) {
        const CarmenOptions chosen = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        LaserLog log;
        ParseCarmen(ReadFile(path), path, chosen, &log);
        return log;
      },
      "path"_a, "options"_a = nullptr,
      "A log of the CARMEN toolkit (FLASER, ROBOTLASERi, RAWLASERi), of one robot.  Options also "
      "as keywords.");
  m.def(
      "format_carmen",
      [](const LaserLog& log, std::size_t robot) {
        if (robot >= log.robots.size())
          throw Error("there is no robot " + std::to_string(robot), ErrorKind::kUsage);
        return FormatCarmen(log, robot);
      },
      "log"_a, "robot"_a = 0, "One robot's scans as ROBOTLASER1 lines.");
  m.def(
      "read_relations",
      [](const std::string& path) {
        std::vector<double> rows;
        const auto relations = ParseRelations(ReadFile(path), path);
        for (const PoseRelation& r : relations)
          for (const double number :
               {r.time_a, r.time_b, r.a_from_b.x, r.a_from_b.y, r.a_from_b.yaw})
            rows.push_back(number);
        return Owned(std::move(rows), {static_cast<py::ssize_t>(relations.size()), 5});
      },
      "path"_a,
      "(n, 5) rows of time a, time b [s], a_from_b [m, m, rad]: ground truth of a planar SLAM "
      "benchmark (Kuemmerle et al. 2009).");
}

void BindOccupancy(py::module_& m) {
  py::enum_<Occupancy>(m, "Occupancy", "What is known of a cell.")
      .value("UNKNOWN", Occupancy::kUnknown, "0: not seen.")
      .value("FREE", Occupancy::kFree, "1: passed.")
      .value("STRUCTURE", Occupancy::kStructure, "2: a wall.");
  py::class_<OccupancyGrid, std::shared_ptr<OccupancyGrid>>(
      m, "OccupancyGrid", "A map of the plane in square cells.  It does not change.")
      .def(py::init([](const Dense<std::uint8_t>& cells, double resolution,
                       const PlanarPose& map_from_grid) {
             ExpectShape(cells, {-1, -1}, "cells");
             if (!(resolution > 0))
               throw Error("resolution: expected a number > 0", ErrorKind::kUsage);
             OccupancyGrid grid;
             grid.resolution = resolution;
             grid.map_from_grid = map_from_grid;
             grid.height = static_cast<std::size_t>(cells.shape(0));
             grid.width = static_cast<std::size_t>(cells.shape(1));
             for (py::ssize_t i = 0; i < cells.size(); ++i) {
               if (cells.data()[i] > 2)
                 throw Error("cells: expected 0 unknown, 1 free or 2 structure, found " +
                                 std::to_string(cells.data()[i]),
                             ErrorKind::kUsage);
               grid.cells.push_back(static_cast<Occupancy>(cells.data()[i]));
             }
             return grid;
           }),
           "cells"_a, "resolution"_a = 0.1, "map_from_grid"_a = std::array<double, 3>{0, 0, 0},
           "cells: (height, width) of 0 unknown, 1 free, 2 structure; row 0 is the lowest, x to "
           "the right, y up.  resolution: a cell's side [m].  map_from_grid: [x m, y m, yaw rad] "
           "of the outer corner of cell (0, 0).")
      .def_readonly("resolution", &OccupancyGrid::resolution, "A cell's side [m].")
      .def_readonly("map_from_grid", &OccupancyGrid::map_from_grid,
                    "[x m, y m, yaw rad] of the outer corner of cell (0, 0).")
      .def_readonly("width", &OccupancyGrid::width, "Cells in x.")
      .def_readonly("height", &OccupancyGrid::height, "Cells in y.")
      .def_property_readonly(
          "cells",
          [](py::object self) {
            const auto& grid = self.cast<const OccupancyGrid&>();
            return View(
                reinterpret_cast<const std::uint8_t*>(grid.cells.data()),
                {static_cast<py::ssize_t>(grid.height), static_cast<py::ssize_t>(grid.width)}, self,
                false);
          },
          "(height, width) of 0 unknown, 1 free, 2 structure; row 0 is the lowest.  Not a copy; "
          "it cannot be written to.")
      .def(
          "png", [](const OccupancyGrid& grid) { return py::bytes(FormatOccupancyPng(grid)); },
          "A picture of a shade a cell, the top row first.")
      .def("world_file", &FormatWorldFile, "Of that picture.")
      .def("__repr__", [](const OccupancyGrid& grid) {
        return "OccupancyGrid(" + std::to_string(grid.width) + " x " + std::to_string(grid.height) +
               " cells of " + Shown(grid.resolution) + " m)";
      });
  m.def("read_occupancy", &ReadOccupancy, "yaml_path"_a,
        "A map as ROS' map_server has it: a YAML file, and the picture that it names.");
  m.def("write_occupancy", &WriteOccupancy, "grid"_a, "path_without_ending"_a,
        "Writes PATH.yaml and PATH.pgm, as map_server reads them.");
}

}  // namespace

void BindLaser(py::module_& module) {
  BindLogs(module);
  BindCarmen(module);
  BindOccupancy(module);
}

}  // namespace graticule::python
