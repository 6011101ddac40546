#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "graticule/io/geography.hpp"
#include "graticule/io/map_drawing.hpp"
#include "graticule/io/map_report.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/problems/mapping/gnss_factors.hpp"
#include "graticule/problems/mapping/map_error.hpp"
#include "graticule/problems/mapping/map_mission.hpp"
#include "graticule/problems/mapping/timed_truth.hpp"
#include "graticule/problems/mapping/transients.hpp"
#include "graticule/solver/provenance.hpp"
#include "ground_truth.hpp"
#include "map_files.hpp"
#include "mission_files.hpp"
#include "mission_recorder.hpp"
#include "output_folder.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

constexpr std::size_t kWays = 500;  // about half a second

LiveMapOptions OptionsOf(const MapCommand& command) {
  LiveMapOptions options;
  options.resolution = command.resolution_m;
  options.ranges.max_range = command.max_range_m;
  if (command.slice > 0) options.slice_size = static_cast<std::size_t>(command.slice);
  options.cover.on = !command.no_cover;
  if (command.cover_news >= 0) options.cover.news = command.cover_news;
  options.votes.bias = command.bias;
  options.threads = 2;
  return options;
}

constexpr double kAllAtOnceS = 1e9;  // from graph to graph: longer than any mission

// The graphs of the sequence, at least one; the mission is recorded where that is asked for.
std::vector<MissionStep> Replay(const MapCommand& command, const LoadedMission& loaded,
                                const Registry& types, const std::string& title,
                                const OutputFolder& folder, const Console& console) {
  std::vector<MissionStep> steps;
  const Mission& mission = loaded.mission;
  MapCommand asked = command;
  if (Interruptible::WasAsked()) asked.every_s = kAllAtOnceS;
  const std::unique_ptr<GraphSequence> sequence = SequenceOf(loaded, asked, types);
  std::optional<MissionRecorder> recorder;
  if (command.record) recorder.emplace(folder, title, MadeBy("map " + title));
  MissionStep step;
  while ((steps.empty() || !Interruptible::WasAsked()) && sequence->Next(&step)) {
    steps.push_back(step);
    console.Progress(
        fmt::format("graph {}: {} of {} nodes", steps.size(), step.nodes, mission.nodes.size()));
    if (recorder) recorder->Keep(step, sequence->Problem());
  }
  console.Progress("");
  if (steps.empty()) throw Error("there is no graph in this mission");
  if (recorder) recorder->Finish(mission, steps.back());
  return steps;
}

MapRun RunOf(const std::string& method, const std::vector<MissionStep>& steps,
             const MappedMission& mapped) {
  MapRun run;
  run.method = method;
  for (std::size_t i = 0; i < mapped.updates.size(); ++i) {
    const MapUpdate& update = mapped.updates[i];
    MapUpdateRow row;
    // One that was stopped ends with the last.
    const bool is_last = i + 1 == mapped.updates.size();
    row.time = (is_last ? steps.back() : steps[i]).time - steps.front().time;
    row.seconds = update.seconds;
    row.nodes = update.nodes;
    row.cover = update.cover;
    row.regenerated_nodes = update.regenerated_nodes;
    row.left_over_slices = update.left_over.size();
    row.dirty_tiles = update.change.dirty_tiles;
    row.flipped_cells = update.change.flips.size();
    run.updates.push_back(row);
  }
  return run;
}

// Its graphs would be written over while they are read.
void RefuseToRecordOntoItself(const MapCommand& command) {
  if (!command.record) return;
  for (const std::string& log : command.logs) {
    if (!IsRecordedMission(log)) continue;
    std::error_code ignored;
    std::filesystem::path folder = log;
    if (!std::filesystem::is_directory(folder))
      folder = std::filesystem::absolute(log).parent_path();
    if (std::filesystem::equivalent(folder, command.output, ignored))
      throw Error("--record: a mission cannot be recorded in the folder that it is read from",
                  ErrorKind::kUsage);
  }
}

void PrintSummary(const MapReport& report) {
  fmt::print("{}\n", report.title);
  for (const auto& [name, value] : report.facts) fmt::print("  {:<13} {}\n", name, value);
  for (const MapRun& run : report.runs) {
    const MapRunTimes times = TimesOf(run);
    fmt::print(
        "  {:<15} {} updates: {} in all, mean {}, 99 % {}, worst {}; structure IoU {:.4f}, known "
        "recall {:.4f}\n",
        run.method, run.updates.size(), Seconds(times.total), Seconds(times.mean),
        Seconds(times.p99), Seconds(times.worst), run.structure_iou, run.known_recall);
  }
  for (const std::string& warning : report.warnings) fmt::print("  warning       {}\n", warning);
}

}  // namespace

int Run(const MapCommand& command, const Console& console) {
  std::optional<Geodetic> datum;
  if (!command.datum.empty()) datum = ParseDatum(command.datum);
  RefuseToRecordOntoItself(command);
  const Registry types = LoadTypes(command.reading);
  OutputFolder folder(command.output);
  std::optional<OccupancyGrid> truth;
  if (!command.truth.empty()) truth = ReadOccupancy(command.truth);
  const Interruptible interruptible;
  MapReport report;
  LoadedMission loaded = LoadMission(command, types, &report, console);
  if (datum && command.gnss.empty() && DatumOf(loaded.mission.graph))
    throw Error("--datum: the mission's graph has satellite fixes, and a datum of its own",
                ErrorKind::kUsage);
  if (datum) loaded.mission.datum = datum;
  const Mission& mission = loaded.mission;
  datum = mission.datum;
  std::map<std::string, std::vector<StampedPose>> true_poses;
  if (!command.comparing.ground_truth.empty())
    true_poses = TrueTrajectories(command.comparing.ground_truth, mission.log.robots, console);
  const std::vector<MissionStep> steps =
      Replay(command, loaded, types, report.title, folder, console);
  const MissionStep& last = steps.back();

  LiveMapOptions options = OptionsOf(command);
  const OccupancyGrid all = MapOfAllNodes(mission, last, options)->Grid();
  std::shared_ptr<const OccupancyMap> map;
  for (const std::string& method : command.methods) {
    if (map && Interruptible::WasAsked()) break;
    options.method = MapMethodOf(method);
    const bool incremental = options.method == MapMethod::kIncremental;
    const double deadline = command.deadline_ms > 0 && incremental
                                ? 1e-3 * command.deadline_ms
                                : std::numeric_limits<double>::infinity();
    const MappedMission mapped = MapMission(mission, steps, options, deadline, [&](std::size_t i) {
      console.Progress(fmt::format("{}: update {} of {}", method, i + 1, steps.size()));
      return !Interruptible::WasAsked();
    });
    MapRun run = RunOf(method, steps, mapped);
    const MapAgreement agreement = CompareMaps(all, mapped.map->Grid());
    run.structure_iou = agreement.Iou(Occupancy::kStructure);
    run.known_recall = agreement.KnownRecall();
    run.known_changed = agreement.KnownChanged();
    report.runs.push_back(std::move(run));
    if (!map) map = mapped.map;
  }
  console.Progress("");

  const OccupancyGrid grid = map->Grid();
  if (grid.cells.empty())
    throw Error(command.logs.front() +
                ": the map is empty: no reading of a scan is below its laser's largest range");
  const auto count = [&](Occupancy what) {
    return static_cast<std::size_t>(std::count(grid.cells.begin(), grid.cells.end(), what));
  };
  const double area = command.resolution_m * command.resolution_m;
  const std::string size = fmt::format(
      "{:.1f} x {:.1f} m, {} free and {} structure cells ({:.0f} m² known)",
      static_cast<double>(grid.width) * grid.resolution,
      static_cast<double>(grid.height) * grid.resolution, ReadableCount(count(Occupancy::kFree)),
      ReadableCount(count(Occupancy::kStructure)),
      area * static_cast<double>(count(Occupancy::kFree) + count(Occupancy::kStructure)));
  report.facts.emplace_back("map", size);
  const GapReport gaps = FindGaps(all, grid, kWays);
  if (gaps.pairs > 0)
    report.facts.emplace_back(
        "ways", fmt::format("of {} tried between places 2 to 6 m apart {} are closed and {} opened "
                            "against the map of all nodes",
                            gaps.pairs, gaps.closed.size(), gaps.opened.size()));
  if (truth) {
    const MapAgreement agreement = CompareMaps(*truth, grid);
    report.facts.emplace_back(
        "truth",
        fmt::format("structure precision {:.4f}, recall {:.4f}, IoU {:.4f}; free "
                    "precision {:.4f}, recall {:.4f}, IoU {:.4f}",
                    agreement.Precision(Occupancy::kStructure),
                    agreement.Recall(Occupancy::kStructure), agreement.Iou(Occupancy::kStructure),
                    agreement.Precision(Occupancy::kFree), agreement.Recall(Occupancy::kFree),
                    agreement.Iou(Occupancy::kFree)));
  }

  if (!true_poses.empty()) {
    report.accuracy = About(command.comparing.ground_truth, [&] {
      return TrajectoryErrors(PairByTime(mission, last, true_poses),
                              ErrorOptionsOf(command.comparing));
    });
    report.accuracy->truth = command.comparing.ground_truth;
    report.facts.emplace_back("poses", AccuracyTitle(*report.accuracy));
    for (const std::string& line : AccuracyLines(*report.accuracy))
      report.facts.emplace_back("", line);
  }

  // The map first: a full disk for the report must not cost it.
  WriteOccupancy(grid, folder.Of("map"));
  WriteGraph(mission, last, folder);
  folder.Write("map.png", FormatOccupancyPng(grid));
  const OccupancyGrid transients = TransientsOf(*map);
  WriteOccupancy(transients, folder.Of("transients"));
  folder.Write("transients.png", FormatOccupancyPng(transients));
  WriteTrajectories(mission, last, folder);
  if (datum) {
    const std::string world = FormatWorldFile(grid);
    for (const char* name : {"map.pgw", "map.wld"}) folder.Write(name, world);
    folder.Write("map.prj", FormatProjection(*datum));
  }
  MapDrawing drawing = DrawingOf(mission, last, grid);
  drawing.title = report.title;
  drawing.subtitle = size;
  const std::string svg = DrawMap(drawing);
  folder.Write("drawing.svg", svg);
  folder.Write("drawing.png", PngFromSvg(svg, 1200));
  folder.Write("report.html", MapReportHtml(report, svg));
  const std::string json = MapReportJson(report);
  folder.Write("report.json", json);
  if (command.json)
    fmt::print("{}", json);
  else
    PrintSummary(report);
  return Interruptible::WasAsked() ? kNotConverged : kDone;
}

}  // namespace graticule::apps
