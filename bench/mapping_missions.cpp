// Simulated missions of the shapes of the thesis' sets, mapped by each method as their graphs grow:
// rows of a Markdown table (docs/mapping.md), and a page with the thesis' figures.
//
// Times are CPU time, adding nodes and poses included; one thread.
//
//   graticule_mapping_missions keswick-like|phase2-like [METHOD...] [PAGE.html]

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/map_drawing.hpp"
#include "graticule/io/map_report.hpp"
#include "graticule/problems/mapping/map_error.hpp"
#include "graticule/problems/mapping/map_mission.hpp"
#include "graticule/problems/mapping/simulate.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

constexpr double kGraphEvery = 10;  // s, as the thesis

std::vector<MissionStep> StepsOf(const Mission& mission) {
  MissionReplay replay(mission, kGraphEvery);
  std::vector<MissionStep> steps;
  for (MissionStep step; replay.Next(&step);) steps.push_back(step);
  return steps;
}

// `cpu`: seconds of each update.
MapRun RunOf(const std::string& method, const std::vector<MissionStep>& steps,
             const MappedMission& mapped, const std::vector<double>& cpu) {
  MapRun run;
  run.method = method;
  for (std::size_t i = 0; i < mapped.updates.size(); ++i) {
    const MapUpdate& update = mapped.updates[i];
    MapUpdateRow row;
    row.time = steps[i].time - steps.front().time;
    row.seconds = cpu[i];
    row.nodes = update.nodes;
    row.cover = update.cover;
    row.regenerated_nodes = update.regenerated_nodes;
    run.updates.push_back(row);
  }
  return run;
}

// Of the cells where somebody went, and that the map knows, the share that is free; and of the
// walls that all nodes together see, the share that is there.
void PrintTransients(const SimulatedMission& simulated, const OccupancyGrid& map) {
  OccupancyGrid swept = simulated.town.grid;
  for (std::size_t i = 0; i < swept.cells.size(); ++i)
    swept.cells[i] = simulated.is_swept[i] ? Occupancy::kFree : Occupancy::kUnknown;
  const MapAgreement agreement = CompareMaps(swept, map);
  const std::size_t free = agreement.Count(Occupancy::kFree, Occupancy::kFree);
  const std::size_t structure = agreement.Count(Occupancy::kFree, Occupancy::kStructure);
  fmt::print("swept cells: {} free, {} structure: {:.4f} free\n", free, structure,
             static_cast<double>(free) / static_cast<double>(free + structure));
}

// Of the last graph's nodes: what the map's agreement with the truth must be read beside.
double PoseError(const SimulatedMission& simulated, const MissionStep& last) {
  double sum = 0;
  for (std::size_t i = 0; i < last.nodes; ++i) {
    const PlanarPose& truth = simulated.world_from_robot[simulated.mission.nodes[i].scan];
    const double x = last.world_from_robot[i].x - truth.x, y = last.world_from_robot[i].y - truth.y;
    sum += x * x + y * y;
  }
  return std::sqrt(sum / static_cast<double>(last.nodes));
}

int Shape(const std::string& name, std::vector<std::string> methods) {
  const SimulatedMission simulated =
      SimulateMission(Builtins(), name == "keswick-like" ? KeswickLike() : Phase2Like());
  const Mission& mission = simulated.mission;
  const Stopwatch clock;
  const std::vector<MissionStep> steps = StepsOf(mission);
  fmt::print("{}: {} robots, {} graphs, {} nodes, {} factors; graphs solved in {:.1f} s\n", name,
             mission.log.robots.size(), steps.size(), mission.nodes.size(),
             mission.graph.FactorCount(), clock.Elapsed().wall);
  const LiveMapOptions plain;
  const OccupancyGrid all = MapOfAllNodes(mission, steps.back(), plain)->Grid();
  fmt::print(
      "| method | total | mean | 99 % | worst | structure IoU | known recall | closed | opened "
      "|\n");
  std::string page;
  if (!methods.empty() && methods.back().size() > 5 &&
      methods.back().compare(methods.back().size() - 5, 5, ".html") == 0) {
    page = methods.back();
    methods.pop_back();
  }
  MapReport report;
  report.title = name;
  report.facts = {{"robots", std::to_string(mission.log.robots.size())},
                  {"graphs", std::to_string(steps.size())},
                  {"nodes", std::to_string(mission.nodes.size())}};
  MapDrawing drawing;
  drawing.title = name;
  if (methods.empty()) methods = {"naive", "naive-cover", "cover-composite", "incremental"};
  for (const std::string& method : methods) {
    LiveMapOptions options;
    options.method = MapMethodOf(method);
    std::vector<double> cpu;
    Stopwatch update;
    const MappedMission mapped = MapMission(
        mission, steps, options, std::numeric_limits<double>::infinity(), [&](std::size_t) {
          cpu.push_back(update.Lap().cpu);
          return true;
        });
    const OccupancyGrid grid = mapped.map->Grid();
    const MapAgreement agreement = CompareMaps(all, grid);
    const GapReport gaps = FindGaps(all, Resample(grid, all), 1000);
    MapRun run = RunOf(method, steps, mapped, cpu);
    run.structure_iou = agreement.Iou(Occupancy::kStructure);
    run.known_recall = agreement.KnownRecall();
    const MapRunTimes times = TimesOf(run);
    report.runs.push_back(std::move(run));
    fmt::print("| {} | {:.3f} s | {:.3f} ms | {:.3f} | {:.3f} | {:.4f} | {:.4f} | {} | {} |\n",
               method, times.total, 1e3 * times.mean, 1e3 * times.p99, 1e3 * times.worst,
               agreement.Iou(Occupancy::kStructure), agreement.KnownRecall(), gaps.closed.size(),
               gaps.opened.size());
    std::fflush(stdout);
    if (method != methods.back()) continue;
    drawing.grid = grid;
    PrintTransients(simulated, grid);
    const MapAgreement truth = CompareMaps(simulated.town.grid, grid);
    fmt::print("truth: structure precision {:.4f}, free precision {:.4f}; poses {:.3f} m rms off\n",
               truth.Precision(Occupancy::kStructure), truth.Precision(Occupancy::kFree),
               PoseError(simulated, steps.back()));
  }
  if (!page.empty()) WriteFile(page, MapReportHtml(report, DrawMap(drawing)));
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  try {
    if (what == "keswick-like" || what == "phase2-like")
      return graticule::Shape(what, std::vector<std::string>(argv + 2, argv + argc));
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "graticule_mapping_missions: {}\n", error.what());
    return 1;
  }
  fmt::print(
      stderr,
      "usage: graticule_mapping_missions keswick-like|phase2-like [METHOD...] [PAGE.html]\n");
  return 2;
}
