#include "mission_files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "graticule/io/bag_laser.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/problems/mapping/front_end.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"
#include "graticule/problems/mapping/placed_mission.hpp"
#include "graticule/problems/mapping/pose_sequence_replay.hpp"
#include "graticule/problems/mapping/relation_error.hpp"
#include "graticule/problems/pose_graph/initialise_and_solve.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "mission_gnss.hpp"
#include "numbers.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

std::string TitleOf(const std::string& path) {
  const std::filesystem::path cleaned = std::filesystem::path(path).lexically_normal();
  return (cleaned.has_filename() ? cleaned : cleaned.parent_path()).filename().string();
}

Mission FromG2o(const std::string& file, const MapCommand& command, const Registry& types,
                MapReport* report) {
  ReadOptions options = OptionsOf(command.reading);
  options.pass_over_sweeps = true;
  Recording recording = ReadProblem(file, types, options);
  for (std::string& note : NotesOf(recording, file)) report->warnings.push_back(std::move(note));
  return MissionFromG2o(std::move(recording.graph), ParseG2oLaser(ReadFile(file), file), file);
}

PlanarPose PoseOfNumbers(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

// X, or X,Y,YAW; one for all logs, or one a log.
std::optional<PlanarPose> LaserOffsetOf(const MapCommand& command, std::size_t log) {
  const std::vector<std::string>& given = command.laser_offsets;
  if (given.empty()) return {};
  if (given.size() != 1 && given.size() != command.logs.size())
    throw Error(fmt::format("--laser-offset is given {} times for {} logs: expected once, or once "
                            "for each",
                            given.size(), command.logs.size()),
                ErrorKind::kUsage);
  const std::string& text = given[given.size() == 1 ? 0 : log];
  const bool is_pose = text.find(',') != std::string::npos;
  std::vector<double> numbers =
      ReadNumbers("--laser-offset", text, is_pose ? 3 : 1, "X or X,Y,YAW, in metres and radians");
  numbers.resize(3);
  return PoseOfNumbers(numbers);
}

std::string Words(const PlanarPose& offset) {
  return fmt::format("{:.3f} m, {:.3f} m, {:.2f} degrees", offset.x, offset.y,
                     offset.yaw * 180 / M_PI);
}

void SayOffset(const std::string& robot, const PlanarPose& given,
               const std::optional<PlanarPose>& logged, MapReport* report) {
  report->facts.emplace_back(
      "laser",
      fmt::format("{} at {} (ahead, left, turned), by --laser-offset; {}", robot, Words(given),
                  logged ? "its log says " + Words(*logged) + ", which is overridden"
                         : "its log does not say"));
}

void ReadBag(const MapCommand& command, std::size_t number, MapReport* report, LaserLog* log) {
  const std::string& file = command.logs[number];
  BagLaserOptions options;
  options.scan_topic = command.scan_topic;
  options.odometry_topic = command.odom_topic;
  options.laser_offset = LaserOffsetOf(command, number);
  const BagLaserSummary summary = ReadBagLaser(file, options, log);
  report->facts.emplace_back(
      "bag", fmt::format("{}: {} scans of {}, odometry of {}", log->robots.back(),
                         ReadableCount(summary.scans), summary.scan_topic, summary.odometry));
  if (options.laser_offset)
    SayOffset(log->robots.back(), *options.laser_offset, summary.told_laser_offset, report);
  else if (!summary.told_laser_offset)
    report->warnings.push_back(
        file +
        ": its transforms do not say where the laser is: taken to be at the robot's centre "
        "(--laser-offset)");
  if (summary.without_odometry > 0)
    report->warnings.push_back(fmt::format("{}: {} scans have no odometry, and are left out", file,
                                           summary.without_odometry));
}

// A log a robot.  What was passed over, and what was not believed, is said.
LaserLog ReadLogs(const MapCommand& command, MapReport* report, std::vector<GnssFix>* fixes) {
  LaserLog log;
  for (std::size_t i = 0; i < command.logs.size(); ++i) {
    const std::string& file = command.logs[i];
    if (Ending(file) == ".bag") {
      ReadBag(command, i, report, &log);
      continue;
    }
    CarmenOptions options;
    options.skip_bad = command.skip_bad;
    options.read_fixes = command.gnss == "log";
    options.laser_offset = LaserOffsetOf(command, i);
    CarmenSummary summary = ParseCarmen(ReadFile(file), file, options, &log);
    if (options.laser_offset)
      SayOffset(log.robots.back(), *options.laser_offset, summary.logged_laser_offset, report);
    if (summary.skipped > 0)
      report->warnings.push_back(fmt::format("{}: {} lines were passed over, the first: {}", file,
                                             summary.skipped, summary.first_skipped));
    if (summary.times == LogTimes::kNone)
      report->warnings.push_back(file + ": its lines do not say when; scans count as seconds");
    if (summary.times == LogTimes::kNone && !command.gnss.empty())
      throw Error(file + ": its lines do not say when, so that no fix can be placed");
    if (summary.other_messages.count("NMEAGGA"))
      report->warnings.push_back(fmt::format("{}: {} satellite fixes are not used (--gnss log)",
                                             file, summary.other_messages.at("NMEAGGA")));
    fixes->insert(fixes->end(), summary.fixes.begin(), summary.fixes.end());
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
  const std::string& file = command.relations;
  if (error.relations == 0)
    throw Error(file +
                ": none of its relations is between times at which there are scans: is it "
                "of this log?");
  if (error.unmatched > error.relations)
    report->warnings.push_back(fmt::format("{}: {} of its {} relations are at times without scans",
                                           file, error.unmatched,
                                           error.unmatched + error.relations));
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
  if (!command.gnss.empty())
    throw Error("--keep-poses draws the map where the logs say: it goes with no --gnss",
                ErrorKind::kUsage);
  std::vector<GnssFix> none;
  LaserLog log = ReadLogs(command, report, &none);
  std::vector<PlanarPose> poses;
  for (const LaserScan& scan : log.scans) poses.push_back(scan.odom_from_robot);
  AddRelations(command, log, poses, report);
  return MissionAsPlaced(std::move(log), types);
}

// Makes the pose graph, which is solved already.
Mission FromLogs(const MapCommand& command, const Registry& types, MapReport* report,
                 const Console& console) {
  std::vector<GnssFix> fixes;
  LaserLog log = ReadLogs(command, report, &fixes);
  const Stopwatch clock;
  FrontEndOptions options;
  for (const std::string& start : command.starts)
    options.starts.push_back(
        PoseOfNumbers(ReadNumbers("--start", start, 3, "X,Y,YAW, in metres and radians")));
  if (!options.starts.empty() && options.starts.size() != log.robots.size())
    throw Error(fmt::format("--start is given {} times for {} robots", options.starts.size(),
                            log.robots.size()),
                ErrorKind::kUsage);
  FrontEndResult built =
      BuildMission(log, types, options, [&](const std::string& stage, double done) {
        console.Progress(fmt::format("{}: {:.0f} %", stage, 100 * done));
        return !Interruptible::WasAsked();
      });
  console.Progress("");
  const FrontEndReport& did = built.report;
  report->facts.emplace_back(
      "graph", fmt::format("in {}: {} closures found in {} searches, {} rejected, {} overlaps",
                           Seconds(clock.Elapsed().wall), did.found, did.searches, did.rejected,
                           did.overlaps));
  const std::set<std::uint32_t> pieces(did.piece_of_robot.begin(), did.piece_of_robot.end());
  if (pieces.size() > 1 && command.gnss.empty())
    report->warnings.push_back(fmt::format(
        "the robots never met: {} maps that lie on each other by chance", pieces.size()));
  AddRelations(command, log, built.world_from_scan, report);
  RobotTracks tracks(log.robots.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i)
    tracks[log.scans[i].robot].push_back({log.scans[i].time, built.world_from_scan[i]});
  Mission mission{std::move(log), std::move(built.graph), {}};
  mission.starts = options.starts;
  for (const FrontEndNode& node : built.nodes)
    mission.nodes.push_back({mission.graph.Find(node.key), node.scan});
  std::stable_sort(mission.nodes.begin(), mission.nodes.end(),
                   [&](const MissionNode& a, const MissionNode& b) {
                     return mission.TimeOf(a) < mission.TimeOf(b);
                   });
  if (!command.gnss.empty()) Georeference(command, fixes, std::move(tracks), &mission, report);
  return mission;
}

}  // namespace

LoadedMission LoadMission(const MapCommand& command, const Registry& types, MapReport* report,
                          const Console& console) {
  const std::string& first = command.logs.front();
  const auto is = [](const char* ending) {
    return [ending](const std::string& file) { return Ending(file) == ending; };
  };
  const auto count = [&](const auto& what) {
    return std::count_if(command.logs.begin(), command.logs.end(), what);
  };
  const auto graphs = count(is(".g2o")), sequences = count(is(".pgseq"));
  const auto recorded = count(IsRecordedMission);
  const auto refuse = [](const std::string& why) { throw Error(why, ErrorKind::kUsage); };
  if (recorded > 0 && command.logs.size() > 1) refuse("a recorded mission goes with no other log");
  if (sequences > 0 && (sequences > 1 || graphs != 1))
    refuse("a .pgseq file goes with one .g2o file that has its scans");
  if (graphs > 0 && command.logs.size() > static_cast<std::size_t>(1 + sequences))
    refuse("a .g2o file with scans is a mission by itself: it goes with no other log");
  const bool is_log = graphs + recorded == 0;
  for (const auto& [given, option] : {std::pair(!command.relations.empty(), "--relations"),
                                      std::pair(!command.laser_offsets.empty(), "--laser-offset"),
                                      std::pair(!command.starts.empty(), "--start"),
                                      std::pair(command.keep_poses, "--keep-poses"),
                                      std::pair(command.gnss == "log", "--gnss log")})
    if (given && !is_log) refuse(std::string(option) + " needs logs, not a mission with a graph");
  if (!command.relations.empty() && command.logs.size() > 1)
    refuse("--relations are those of one robot: it goes with one log");
  if (!command.antenna.empty() && command.gnss.empty()) refuse("--antenna goes with --gnss");

  report->title = TitleOf(first);
  if (command.logs.size() > 1)
    report->title += fmt::format(" and {} more", command.logs.size() - 1);
  LoadedMission loaded{{{}, Graph(types), {}}, {}, {}};
  Mission& mission = loaded.mission;
  if (recorded > 0) {
    loaded.recorded = OpenRecordedMission(first);
    mission = ReadRecordedMission(*loaded.recorded, types);
    if (!loaded.recorded->index.title.empty()) report->title = loaded.recorded->index.title;
  } else if (graphs > 0) {
    const auto file = std::find_if(command.logs.begin(), command.logs.end(), is(".g2o"));
    mission = FromG2o(*file, command, types, report);
  } else {
    mission = command.keep_poses ? Placed(command, types, report)
                                 : FromLogs(command, types, report, console);
  }
  if (sequences > 0) {
    const auto file = std::find_if(command.logs.begin(), command.logs.end(), is(".pgseq"));
    loaded.sequence = ParsePoseSequence(ReadFile(*file), *file);
    mission = CutIntoRobots(std::move(mission), *loaded.sequence, *file);
  }
  if (mission.nodes.empty())
    throw Error(first + ": there are no scans to make a map of", ErrorKind::kOther);
  if (!is_log && !command.gnss.empty()) {
    // Its own graphs are of another world: they are made anew.
    loaded.sequence.reset();
    loaded.recorded.reset();
    mission.graph.SetValues(
        InitialiseAndSolve(&mission.graph, InitialGuess::kAutomatic, true, {}).solution.values);
    Georeference(command, {}, TracksOfNodes(mission), &mission, report);
  }
  if (!mission.datum) mission.datum = DatumOf(mission.graph);
  report->facts.emplace_back("robots", std::to_string(mission.log.robots.size()));
  report->facts.emplace_back(
      "nodes", fmt::format("{} with a scan, over {}", ReadableCount(mission.nodes.size()),
                           ReadableSeconds(mission.TimeOf(mission.nodes.back()) -
                                           mission.TimeOf(mission.nodes.front()))));
  return loaded;
}

std::unique_ptr<GraphSequence> SequenceOf(const LoadedMission& loaded, const MapCommand& command,
                                          const Registry& types) {
  const Mission& mission = loaded.mission;
  if (loaded.recorded)
    return std::make_unique<RecordedSequence>(
        *loaded.recorded, types, mission.TimeOf(mission.nodes.front()), command.every_s);
  const double every_s = command.every_s > 0 ? command.every_s : kEveryS;
  if (loaded.sequence)
    return std::make_unique<PoseSequenceReplay>(mission, *loaded.sequence, every_s);
  return std::make_unique<MissionReplay>(mission, every_s);
}

}  // namespace graticule::apps
