#include "bind.hpp"
#include "graticule/problems/mapping/live_map.hpp"
#include "graticule/problems/mapping/map_mission.hpp"
#include "observer.hpp"
#include "poses.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

void BindOptions(py::module_& m) {
  py::enum_<MapMethod>(m, "MapMethod", "How a map is made from the graph's nodes.")
      .value("NAIVE", MapMethod::kNaive, "All nodes, at every update.")
      .value("NAIVE_COVER", MapMethod::kNaiveCover, "The cover's nodes, at every update.")
      .value("COVER_COMPOSITE", MapMethod::kCoverComposite, "Algorithm 2.1.")
      .value("INCREMENTAL", MapMethod::kIncremental, "Only slices that moved.");
  Record<RangeUse>(m, "RangeUse", "Which readings count, and how far.")
      .Field("max_range", &RangeUse::max_range, "A longer beam passes, and hits nothing [m].")
      .Field("clear_no_return", &RangeUse::clear_no_return,
             "Whether a beam that did not return passes the cells up to max_range.");
  Record<VoteRule>(m, "VoteRule", "How a cell's hits and passes become a label.")
      .Field("hit_votes", &VoteRule::hit_votes, "1 .. 15")
      .Field("pass_votes", &VoteRule::pass_votes, "1 .. 15")
      .Field("bias", &VoteRule::bias, "Above 0: walls stay; below: doorways clear sooner.")
      .Field("structure_from", &VoteRule::structure_from, "Score of structure.")
      .Field("free_to", &VoteRule::free_to, "Score of free; below structure_from.")
      .Field("saturation", &VoteRule::saturation, "2^n - 1; 0: no limit.");
  Record<CoverOptions>(m, "CoverOptions", "Which nodes' scans the map is made of.")
      .Field("on", &CoverOptions::on, "Else all of them.")
      .Field("news", &CoverOptions::news, "A node with no larger share of news is left out.")
      .Field("views", &CoverOptions::views, "That each cell is to be seen by, 1 .. 7.")
      .Field("across_robots", &CoverOptions::across_robots, "What other robots saw counts too.");
  Record<LiveMapOptions>(m, "LiveMapOptions", "How a live map is made.")
      .Field("method", &LiveMapOptions::method, "Which.")
      .Field("resolution", &LiveMapOptions::resolution, "A cell's side [m].")
      .Field("ranges", &LiveMapOptions::ranges, "Which readings count.")
      .Field("slice_size", &LiveMapOptions::slice_size, "Nodes that are drawn anew together.")
      .Field("regenerate_above", &LiveMapOptions::regenerate_above,
             "A slice that moved farther is drawn anew [cells].")
      .Field("cover", &LiveMapOptions::cover, "Which nodes count.")
      .Field("votes", &LiveMapOptions::votes, "How cells are labelled.")
      .Field("threads", &LiveMapOptions::threads, "The map is the same for any number.");
}

void BindMap(py::module_& m) {
  py::class_<OccupancyMap, std::shared_ptr<OccupancyMap>>(
      m, "OccupancyMap", "The ternary map of a moment: it never changes.")
      .def_property_readonly("resolution", &OccupancyMap::Resolution, "A cell's side [m].")
      .def_property_readonly("version", &OccupancyMap::Version, "Grows with each change.")
      .def(
          "grid", [](const OccupancyMap& map) { return map.Grid(); },
          "The map as an array: the smallest box that has all known cells.")
      .def("at_place", &OccupancyMap::AtPlace, "x"_a, "y"_a,
           "Of a place in the world [m]; UNKNOWN far off.")
      .def(
          "frontier",
          [](const OccupancyMap& map) {
            std::vector<double> places;
            const CellBox box = map.KnownBox();
            for (int y = box.bottom; y < box.bottom + box.height; ++y)
              for (int x = box.left; x < box.left + box.width; ++x)
                if (map.IsFrontier(x, y))
                  for (const int cell : {x, y}) places.push_back((cell + 0.5) * map.Resolution());
            const auto count = static_cast<py::ssize_t>(places.size() / 2);
            return Owned(std::move(places), {count, 2});
          },
          "(n, 2) centres of free cells beside unknown ones, in the world [m].")
      .def(
          "changed_since",
          [](const OccupancyMap& map, std::uint64_t version) {
            std::vector<double> corners;
            for (const TileIndex tile : map.ChangedSince(version))
              for (const int cell : {tile.x, tile.y})
                corners.push_back(cell * kTileSide * map.Resolution());
            const auto count = static_cast<py::ssize_t>(corners.size() / 2);
            return Owned(std::move(corners), {count, 2});
          },
          "version"_a,
          "(n, 2) lower left corners of the tiles (16 x 16 cells) that have changed since a "
          "version, in the world [m].");
  Record<MapUpdate>(m, "MapUpdate", "What an update did.")
      .Result("seconds", &MapUpdate::seconds, "Wall.")
      .Result("version", &MapUpdate::version, "Of the map.")
      .Result("nodes", &MapUpdate::nodes, "Added so far.")
      .Result("cover", &MapUpdate::cover, "Of these, in the cover.")
      .Result("slices", &MapUpdate::slices, "Of the cover.")
      .Result("regenerated_slices", &MapUpdate::regenerated_slices, "Drawn anew.")
      .Result("regenerated_nodes", &MapUpdate::regenerated_nodes, "Drawn anew.")
      .Result("waiting", &MapUpdate::waiting, "(n,) nodes that the deadline left out.");
}

// Updates take long, and wait for nothing of Python's.
template <class Update>
MapUpdate Updated(const Update& update) {
  const py::gil_scoped_release released;
  return update();
}

void BindLive(py::module_& m) {
  py::class_<LiveMap>(m, "LiveMap",
                      "The occupancy map of a team of robots, kept up to date as their pose "
                      "graph grows and moves: COVER_COMPOSITE of the thesis, Algorithm 2.1.")
      .def(py::init([](const LiveMapOptions* options, const py::kwargs& keywords) {
             return std::make_unique<LiveMap>(OptionsFrom(options, keywords));
           }),
           "options"_a = nullptr, "Options also as keywords.")
      .def(
          "add_node",
          [](LiveMap& map, std::uint32_t robot, const LaserGeometry& geometry,
             const std::vector<float>& ranges,
             const PlanarPose& pose) { return map.AddNode(robot, geometry, ranges, pose); },
          "robot"_a, "geometry"_a, "ranges"_a, "world_from_robot"_a,
          "A new pose of a robot, [x m, y m, yaw rad], with the scan taken there, (beams,) [m].  "
          "Returns its number.")
      .def("update_pose", &LiveMap::UpdatePose, "node"_a, "world_from_robot"_a,
           "Where a node is now.")
      .def(
          "update_poses",
          [](LiveMap& map, const Dense<double>& poses) {
            map.UpdatePoses(PlanarPosesOf(poses, "world_from_robot"));
          },
          "world_from_robot"_a, "(nodes, 3) where all nodes are now: x m, y m, yaw rad.")
      .def(
          "update",
          [](LiveMap& map, double deadline) {
            return Updated([&] { return map.Update(deadline); });
          },
          "deadline"_a = std::numeric_limits<double>::infinity(),
          "Brings the map up to date, in time for a deadline [s, wall].")
      .def(
          "update_exactly",
          [](LiveMap& map) { return Updated([&] { return map.UpdateExactly(); }); },
          "Draws every slice anew that has moved at all.")
      .def(
          "map", [](const LiveMap& map) { return OccupancyMap(*map.Map()); },
          "The map of the last update; it shares what is equal with others.")
      .def_property_readonly("node_count", &LiveMap::NodeCount, "Added so far.")
      .def_property_readonly("cover", &LiveMap::Cover, "(n,) nodes in the cover.");

  py::class_<MappedMission>(m, "MappedMission", "A mission's map, and the updates to it.")
      .def_readonly("updates", &MappedMission::updates, "One for each graph.")
      .def_property_readonly(
          "map", [](const MappedMission& self) { return OccupancyMap(*self.map); },
          "With every node where the last graph has it.");
  m.def(
      "map_mission",
      [](const Mission& mission, const std::vector<MissionStep>& steps,
         const LiveMapOptions* options, double deadline_s, const py::kwargs& keywords) {
        const LiveMapOptions chosen = OptionsFrom(options, keywords);
        PythonObserver observer;
        auto mapped = [&] {
          const py::gil_scoped_release released;
          return MapMission(mission, steps, chosen, deadline_s, [&](std::size_t) {
            const py::gil_scoped_acquire acquired;
            return observer.Goes([] { return true; });
          });
        }();
        observer.Rethrow();
        return mapped;
      },
      "mission"_a, "steps"_a, "options"_a = nullptr,
      "deadline_s"_a = std::numeric_limits<double>::infinity(),
      "Draws a sequence of graphs as a live map would have.  Options also as keywords.");
}

}  // namespace

void BindLiveMap(py::module_& module) {
  BindOptions(module);
  BindMap(module);
  BindLive(module);
}

}  // namespace graticule::python
