#include <algorithm>

#include "bind.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/mapping/front_end.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"
#include "graticule/problems/mapping/placed_mission.hpp"
#include "graticule/problems/mapping/recorded_folder.hpp"
#include "graticule/problems/mapping/simulate.hpp"
#include "observer.hpp"
#include "poses.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

Registry TypesOf(const Registry* types) { return types ? *types : Builtins(); }

void BindFrontEnd(py::module_& m) {
  Record<FrontEndOptions>(m, "FrontEndOptions", "How a log becomes a pose graph.")
      .Options(FrontEndOptionTable())
      .Field("starts", &FrontEndOptions::starts,
             "Where each robot begins, in one frame: [x m, y m, yaw rad] each; empty: unknown.")
      .Field("start_sigma", &FrontEndOptions::start_sigma, "How well that is known [m].")
      .Field("start_sigma_yaw", &FrontEndOptions::start_sigma_yaw, "How well that is known [rad].")
      .Field("solve", &FrontEndOptions::solve, "Of the pose graph.");
  Record<FrontEndReport>(m, "FrontEndReport", "What the front end did.")
      .Result("scans", &FrontEndReport::scans, "Of the log.")
      .Result("nodes", &FrontEndReport::nodes, "Of the graph.")
      .Result("searches", &FrontEndReport::searches, "Closures that were looked for.")
      .Result("found", &FrontEndReport::found, "Of these, found.")
      .Result("rejected", &FrontEndReport::rejected, "Of these, inconsistent.")
      .Result("overlaps", &FrontEndReport::overlaps, "Matches once poses were known.")
      .Result("rounds", &FrontEndReport::rounds, "Of searching and solving.")
      .Result("piece_of_robot", &FrontEndReport::piece_of_robot,
              "(robots,) robots of one piece are in one frame.")
      .Result("seconds_follow", &FrontEndReport::seconds_follow, "Wall.")
      .Result("seconds_close", &FrontEndReport::seconds_close, "Wall.")
      .Result("seconds_refine", &FrontEndReport::seconds_refine, "Wall.");
  py::class_<FrontEndResult>(m, "FrontEndResult", "A log as a pose graph, solved.")
      .def_readonly("graph", &FrontEndResult::graph,
                    "se2/1 along each robot's way; its own values are the solution.")
      .def_readonly("report", &FrontEndResult::report, "What was done.")
      .def_property_readonly(
          "keys",
          [](const FrontEndResult& self) {
            std::vector<Key> keys;
            for (const FrontEndNode& node : self.nodes) keys.push_back(node.key);
            return keys;
          },
          "Of the nodes, robot by robot.")
      .def_property_readonly(
          "scans",
          [](const FrontEndResult& self) {
            std::vector<std::size_t> scans;
            for (const FrontEndNode& node : self.nodes) scans.push_back(node.scan);
            return scans;
          },
          "(nodes,) which scan of the log was taken there.")
      .def_property_readonly(
          "world_from_node",
          [](const FrontEndResult& self) { return RowsOf(self.world_from_node); },
          "(nodes, 3) x m, y m, yaw rad.")
      .def_property_readonly(
          "world_from_scan",
          [](const FrontEndResult& self) { return RowsOf(self.world_from_scan); },
          "(scans, 3) the robot's pose at every scan of the log: x m, y m, yaw rad.");
  m.def(
      "build_mission",
      [](const LaserLog& log, const FrontEndOptions* options, const Registry* types,
         const py::object& watch, const py::kwargs& keywords) {
        const FrontEndOptions chosen = OptionsFrom(options, keywords);
        const Registry known = TypesOf(types);
        PythonObserver observer;
        const auto told = [&](const std::string& stage, double done) {
          const py::gil_scoped_acquire acquired;
          return observer.Goes([&] {
            return watch.is_none() || !py::object(watch(stage, done)).is(py::bool_(false));
          });
        };
        auto result = [&] {
          const py::gil_scoped_release released;
          return BuildMission(log, known, chosen, told);
        }();
        observer.Rethrow();
        return result;
      },
      "log"_a, "options"_a = nullptr, "types"_a = nullptr, py::kw_only(), "watch"_a = py::none(),
      "From raw scans to a solved pose graph: scans are matched one after the other, loops closed "
      "and verified, overlaps matched (docs/mapping_front_end.md).  Options also as keywords.  "
      "`watch(stage, done)` is told what is being done, and how much of it, 0 to 1; where it says "
      "False, no more loops are looked for.  What it throws, and Ctrl-C, is thrown at the end.");
}

void BindMission(py::module_& m) {
  py::class_<Mission, std::shared_ptr<Mission>>(
      m, "Mission", "What a team of robots saw, and the pose graph that says where it was.")
      .def(py::init([](const LaserLog& log, const FrontEndResult& front_end) {
             Mission mission{log, front_end.graph, {}, {}, {}};
             for (const FrontEndNode& node : front_end.nodes)
               mission.nodes.push_back({mission.graph.IdOf(node.key), node.scan});
             std::stable_sort(mission.nodes.begin(), mission.nodes.end(),
                              [&](const MissionNode& a, const MissionNode& b) {
                                return mission.TimeOf(a) < mission.TimeOf(b);
                              });
             return mission;
           }),
           "log"_a, "front_end"_a, "Of a log, and what the front end made of it: copies.")
      .def_readonly("log", &Mission::log, "Scans.")
      .def_readonly("graph", &Mission::graph, "se2/1 poses of the nodes.")
      .def_readonly("datum", &Mission::datum,
                    "Of the graph's world: x east and y north of here; None: it lies anyhow.")
      .def("__len__", [](const Mission& self) { return self.nodes.size(); })
      .def_property_readonly(
          "scans",
          [](const Mission& self) {
            std::vector<std::size_t> scans;
            for (const MissionNode& node : self.nodes) scans.push_back(node.scan);
            return scans;
          },
          "(nodes,) which scan was taken at each node, in the order in which they came.")
      .def_property_readonly(
          "world_from_node",
          [](const Mission& self) {
            std::vector<PlanarPose> poses;
            for (const MissionNode& node : self.nodes) {
              const Span<const double> value = self.graph.ValueOf(node.variable);
              poses.push_back({value[0], value[1], value[2]});
            }
            return RowsOf(poses);
          },
          "(nodes, 3) as the graph has them: x m, y m, yaw rad.")
      .def("__repr__", [](const Mission& self) {
        return "Mission(" + std::to_string(self.log.robots.size()) + " robots, " +
               std::to_string(self.nodes.size()) + " nodes)";
      });
  m.def(
      "read_g2o_mission",
      [](const std::string& path, const Registry* types) {
        const std::string text = ReadFile(path);
        Recording recording = ParseProblem(text, path, TypesOf(types));
        return MissionFromG2o(std::move(recording.graph), ParseG2oLaser(text, path), path);
      },
      "path"_a, "types"_a = nullptr, "The mission of a g2o file with scans after its vertices.");
  m.def(
      "read_mission",
      [](const std::string& path, const Registry* types) {
        return ReadRecordedMission(OpenRecordedMission(path), TypesOf(types));
      },
      "path"_a, "types"_a = nullptr,
      "A recorded mission (docs/mapping.md): its folder, or the `mission.index` in it.  The graph "
      "is the last of its sequence.");
  m.def(
      "mission_as_placed",
      [](const LaserLog& log, double distance, double turn, const Registry* types) {
        return MissionAsPlaced(log, TypesOf(types), distance, turn);
      },
      "log"_a, "node_distance_m"_a = 0.2, "node_turn_rad"_a = 0.2, "types"_a = nullptr,
      "A mission whose log has the right poses already: they are kept.");
  Record<MissionStep>(m, "MissionStep", "A graph of a mission's sequence, solved.")
      .Result("time", &MissionStep::time, "Of the log [s].")
      .Result("nodes", &MissionStep::nodes, "The first so many of the mission's.")
      .Class()
      .def_property_readonly(
          "world_from_robot", [](const MissionStep& step) { return RowsOf(step.world_from_robot); },
          "(nodes, 3) x m, y m, yaw rad.");
  m.def(
      "read_mission_steps",
      [](const std::string& path, double begin, double every_s, const Registry* types) {
        const Registry known = TypesOf(types);
        const py::gil_scoped_release released;
        const RecordedFolder folder = OpenRecordedMission(path);
        RecordedSequence sequence(folder, known, begin, every_s);
        std::vector<MissionStep> steps;
        for (MissionStep step; sequence.Next(&step);) steps.push_back(step);
        return steps;
      },
      "path"_a, "begin"_a = 0.0, "every_s"_a = 0.0, "types"_a = nullptr,
      "The sequence of graphs G_1 .. G_n of a recorded mission, as it was recorded.  every_s: of "
      "each period from `begin` on [s] the last; 0: all.");
  m.def(
      "replay_mission",
      [](const Mission& mission, double every_s) {
        const py::gil_scoped_release released;
        MissionReplay replay(mission, every_s);
        std::vector<MissionStep> steps;
        for (MissionStep step; replay.Next(&step);) steps.push_back(step);
        return steps;
      },
      "mission"_a, "every_s"_a,
      "The sequence of graphs G_1 .. G_n as an online solver would have had them.");
}

void BindSimulation(py::module_& m) {
  Record<TownOptions>(m, "TownOptions", "A town to be mapped.")
      .Field("width_m", &TownOptions::width_m, "[m]")
      .Field("height_m", &TownOptions::height_m, "[m]")
      .Field("block_m", &TownOptions::block_m, "From street to street [m].")
      .Field("street_m", &TownOptions::street_m, "Width of the streets [m].")
      .Field("yards", &TownOptions::yards, "Share of blocks without a house.")
      .Field("resolution", &TownOptions::resolution, "A cell's side [m].")
      .Field("seed", &TownOptions::seed, "Same options, same town.");
  Record<MissionOptions>(m, "MissionOptions", "A team of robots that explores a town.")
      .Field("town", &MissionOptions::town, "The place.")
      .Field("robots", &MissionOptions::robots, "How many.")
      .Field("duration_s", &MissionOptions::duration_s, "[s]")
      .Field("scan_every_s", &MissionOptions::scan_every_s, "[s]")
      .Field("speed_m_s", &MissionOptions::speed_m_s, "[m/s]")
      .Field("node_every_m", &MissionOptions::node_every_m, "[m]")
      .Field("node_every_rad", &MissionOptions::node_every_rad, "[rad]")
      .Field("beams", &MissionOptions::beams, "Over 180 degrees, ahead.")
      .Field("max_range_m", &MissionOptions::max_range_m, "[m]")
      .Field("range_sigma_m", &MissionOptions::range_sigma_m, "[m]")
      .Field("no_return", &MissionOptions::no_return, "Share of beams that see nothing.")
      .Field("odometry_sigma", &MissionOptions::odometry_sigma, "Of the metres driven.")
      .Field("match_sigma_m", &MissionOptions::match_sigma_m, "Of the graph's factors [m].")
      .Field("match_sigma_rad", &MissionOptions::match_sigma_rad, "[rad]")
      .Field("closure_range_m", &MissionOptions::closure_range_m, "[m]")
      .Field("people", &MissionOptions::people, "That walk about.")
      .Field("vehicles", &MissionOptions::vehicles, "That drive about.")
      .Field("seed", &MissionOptions::seed, "Same options, same digits.");
  py::class_<SimulatedMission>(m, "SimulatedMission", "A mission with truth.")
      .def_readonly("mission", &SimulatedMission::mission, "As a front end would make it.")
      .def_property_readonly(
          "world_from_robot",
          [](const SimulatedMission& self) { return RowsOf(self.world_from_robot); },
          "(scans, 3) the truth: x m, y m, yaw rad.")
      .def_property_readonly(
          "town", [](const SimulatedMission& self) { return self.town.grid; },
          "The true map: every cell structure or free.");
  m.def(
      "simulate_mission",
      [](const MissionOptions* options, const py::kwargs& keywords) {
        const MissionOptions chosen = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        return SimulateMission(Builtins(), chosen);
      },
      "options"_a = nullptr, "Options also as keywords.");
}

}  // namespace

void BindMapping(py::module_& module) {
  BindFrontEnd(module);
  BindMission(module);
  BindSimulation(module);
}

}  // namespace graticule::python
