#include "mission_files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>

#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/problems/mapping/front_end.hpp"
#include "graticule/problems/mapping/placed_mission.hpp"
#include "graticule/problems/mapping/relation_error.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

Mission FromG2o(const MapCommand& command, const Registry& types, const Console& console) {
  const std::string& file = command.logs.front();
  Reading reading = command.reading;
  reading.skip_unknown = true;  // the scans, which are read by another
  Console silent = console;
  silent.quiet = true;  // of what was skipped
  Recording recording = Load(file, reading, types, silent);
  return MissionFromG2o(std::move(recording.graph), ParseG2oLaser(ReadFile(file), file), file);
}

// A log a robot.  What was passed over is said.
LaserLog ReadLogs(const MapCommand& command, MapReport* report) {
  LaserLog log;
  for (const std::string& file : command.logs) {
    CarmenOptions options;
    options.skip_bad = command.skip_bad;
    const CarmenSummary summary = ParseCarmen(ReadFile(file), file, options, &log);
    if (summary.skipped > 0)
      report->warnings.push_back(fmt::format("{}: {} lines were passed over, the first: {}", file,
                                             summary.skipped, summary.first_skipped));
    if (summary.times == LogTimes::kNone)
      report->warnings.push_back(file + ": its lines do not say when; scans count as seconds");
  }
  return log;
}

RelationError ErrorOf(const LaserLog& log, const std::vector<PlanarPose>& world_from_scan,
                      const std::string& relations) {
  std::vector<TimedPose> poses;
  for (std::size_t i = 0; i < log.scans.size(); ++i)
    poses.push_back({log.scans[i].time, world_from_scan[i]});
  return CompareWithRelations(std::move(poses), ParseRelations(ReadFile(relations), relations));
}

void AddRelations(const MapCommand& command, const LaserLog& log,
                  const std::vector<PlanarPose>& world_from_scan, MapReport* report) {
  if (command.relations.empty()) return;
  const RelationError error = ErrorOf(log, world_from_scan, command.relations);
  report->facts.emplace_back(
      "relations",
      fmt::format("{} ({} unmatched): {:.4f} ± {:.4f} m, {:.3f} ± {:.3f} degrees", error.relations,
                  error.unmatched, error.translation_m.mean, error.translation_m.deviation,
                  error.rotation_rad.mean * 180 / M_PI, error.rotation_rad.deviation * 180 / M_PI));
}

// The logs say where their robots were.
Mission Placed(const MapCommand& command, const Registry& types, MapReport* report) {
  if (!command.starts.empty())
    throw Error("--keep-poses takes where robots begin from the logs: it goes with no --start",
                ErrorKind::kUsage);
  LaserLog log = ReadLogs(command, report);
  std::vector<PlanarPose> poses;
  for (const LaserScan& scan : log.scans) poses.push_back(scan.odom_from_robot);
  AddRelations(command, log, poses, report);
  return MissionAsPlaced(std::move(log), types);
}

PlanarPose ReadStart(const std::string& text) {
  double numbers[3];
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    const bool ends_well = i < 2 ? next != end && *next == ',' : next == end;
    if (error != std::errc() || !ends_well || !std::isfinite(numbers[i]))
      throw Error("--start '" + text + "': expected X,Y,YAW, in metres and radians",
                  ErrorKind::kUsage);
    at = next + 1;
  }
  return {numbers[0], numbers[1], numbers[2]};
}

// Makes the pose graph, which is solved already.
Mission FromLogs(const MapCommand& command, const Registry& types, MapReport* report,
                 const Console& console) {
  LaserLog log = ReadLogs(command, report);
  const Stopwatch clock;
  FrontEndOptions options;
  for (const std::string& start : command.starts) options.starts.push_back(ReadStart(start));
  if (!options.starts.empty() && options.starts.size() != log.robots.size())
    throw Error(fmt::format("--start is given {} times for {} robots", options.starts.size(),
                            log.robots.size()),
                ErrorKind::kUsage);
  FrontEndResult built =
      BuildMission(log, types, options, [&](const std::string& stage, double done) {
        console.Progress(fmt::format("{}: {:.0f} %", stage, 100 * done));
      });
  console.Progress("");
  const FrontEndReport& did = built.report;
  report->facts.emplace_back(
      "graph", fmt::format("in {}: {} closures found in {} searches, {} rejected, {} overlaps",
                           Seconds(clock.Elapsed().wall), did.found, did.searches, did.rejected,
                           did.overlaps));
  const std::set<std::uint32_t> pieces(did.piece_of_robot.begin(), did.piece_of_robot.end());
  if (pieces.size() > 1)
    report->warnings.push_back(fmt::format(
        "the robots never met: {} maps that lie on each other by chance", pieces.size()));
  AddRelations(command, log, built.world_from_scan, report);
  Mission mission{std::move(log), std::move(built.graph), {}};
  for (const FrontEndNode& node : built.nodes)
    mission.nodes.push_back({mission.graph.Find(node.key), node.scan});
  std::stable_sort(mission.nodes.begin(), mission.nodes.end(),
                   [&](const MissionNode& a, const MissionNode& b) {
                     return mission.TimeOf(a) < mission.TimeOf(b);
                   });
  return mission;
}

}  // namespace

Mission LoadMission(const MapCommand& command, const Registry& types, MapReport* report,
                    const Console& console) {
  const auto is_g2o = [](const std::string& file) { return Ending(file) == ".g2o"; };
  const bool has_graph = std::any_of(command.logs.begin(), command.logs.end(), is_g2o);
  if (has_graph && command.logs.size() > 1)
    throw Error("a .g2o file with scans is a mission by itself: it goes with no other log",
                ErrorKind::kUsage);
  if (has_graph && !command.relations.empty())
    throw Error("--relations needs logs with times, not a .g2o file", ErrorKind::kUsage);
  if (has_graph && command.keep_poses)
    throw Error("--keep-poses is for logs; the poses of a .g2o file are its graph's",
                ErrorKind::kUsage);
  report->title = std::filesystem::path(command.logs.front()).filename().string();
  if (command.logs.size() > 1)
    report->title += fmt::format(" and {} more", command.logs.size() - 1);
  Mission mission = has_graph            ? FromG2o(command, types, console)
                    : command.keep_poses ? Placed(command, types, report)
                                         : FromLogs(command, types, report, console);
  if (mission.nodes.empty())
    throw Error(command.logs.front() + ": there are no scans to make a map of", ErrorKind::kOther);
  report->facts.emplace_back("robots", std::to_string(mission.log.robots.size()));
  report->facts.emplace_back(
      "nodes", fmt::format("{} with a scan, over {}", ReadableCount(mission.nodes.size()),
                           ReadableSeconds(mission.TimeOf(mission.nodes.back()) -
                                           mission.TimeOf(mission.nodes.front()))));
  return mission;
}

}  // namespace graticule::apps
