// Simulated missions of the shapes of the thesis' sets, mapped by each method as their graphs grow,
// and missions of growing length, area and team: rows of Markdown tables (docs/mapping.md).
//
//   graticule_mapping_missions keswick-like | phase2-like [METHOD...]
//   graticule_mapping_missions length | area | robots

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
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

MapRun RunOf(const MappedMission& mapped) {
  MapRun run;
  for (const MapUpdate& update : mapped.updates) {
    MapUpdateRow row;
    row.seconds = update.seconds;
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
  if (methods.empty()) methods = {"naive", "naive-cover", "cover-composite", "incremental"};
  for (const std::string& method : methods) {
    LiveMapOptions options;
    options.method = MapMethodOf(method);
    const MappedMission mapped = MapMission(mission, steps, options);
    const OccupancyGrid grid = mapped.map->Grid();
    const MapAgreement agreement = CompareMaps(all, grid);
    const GapReport gaps = FindGaps(all, Resample(grid, all), 1000);
    const MapRunTimes times = TimesOf(RunOf(mapped));
    fmt::print("| {} | {:.3f} s | {:.3f} ms | {:.3f} | {:.3f} | {:.4f} | {:.4f} | {} | {} |\n",
               method, times.total, 1e3 * times.mean, 1e3 * times.p99, 1e3 * times.worst,
               agreement.Iou(Occupancy::kStructure), agreement.KnownRecall(), gaps.closed.size(),
               gaps.opened.size());
    if (method != methods.back()) continue;
    PrintTransients(simulated, grid);
    const MapAgreement truth = CompareMaps(simulated.town.grid, grid);
    fmt::print("truth: structure precision {:.4f}, free precision {:.4f}\n",
               truth.Precision(Occupancy::kStructure), truth.Precision(Occupancy::kFree));
  }
  return 0;
}

// The last quarter's updates: what one costs when so much has been seen.
int Scale(const std::string& what) {
  fmt::print("| {} | nodes | cover | mean of the last quarter [ms] | worst of it |\n", what);
  for (const double factor : {1.0, 2.0, 4.0, 8.0}) {
    MissionOptions options;
    options.duration_s = what == "length" ? 450 * factor : 900;
    options.robots = what == "robots" ? static_cast<int>(2 * factor) : 4;
    if (what == "area") options.town.width_m = 60 * factor;
    const SimulatedMission simulated = SimulateMission(Builtins(), options);
    const std::vector<MissionStep> steps = StepsOf(simulated.mission);
    const MappedMission mapped = MapMission(simulated.mission, steps, {});
    MapRun last = RunOf(mapped);
    last.updates.erase(last.updates.begin(),
                       last.updates.begin() + static_cast<long>(last.updates.size() * 3 / 4));
    const MapRunTimes times = TimesOf(last);
    fmt::print("| {} | {} | {} | {:.3f} | {:.3f} |\n",
               what == "length" ? fmt::format("{:.0f} s", options.duration_s)
               : what == "robots"
                   ? fmt::format("{}", options.robots)
                   : fmt::format("{:.0f} m2", options.town.width_m * options.town.height_m),
               mapped.updates.back().nodes, mapped.updates.back().cover, 1e3 * times.mean,
               1e3 * times.worst);
  }
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  try {
    if (what == "keswick-like" || what == "phase2-like")
      return graticule::Shape(what, std::vector<std::string>(argv + 2, argv + argc));
    if (what == "length" || what == "area" || what == "robots") return graticule::Scale(what);
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "graticule_mapping_missions: {}\n", error.what());
    return 1;
  }
  fmt::print(stderr,
             "usage: graticule_mapping_missions keswick-like|phase2-like [METHOD...]\n"
             "       graticule_mapping_missions length|area|robots\n");
  return 2;
}
