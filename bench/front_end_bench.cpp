// From recorded laser logs to pose graphs: errors against the relations of Kuemmerle et al. 2009,
// and seconds against the length of the log.
//
//   graticule_front_end                       the four sets of data/mapping/kuemmerle
//   graticule_front_end LOG [--relations FILE] [--picture FILE.png] [--laser-offset METRES]
//                           [--pieces N]      N robots whose starts nobody knows, cut from one log

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/relations.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/mapping/front_end.hpp"
#include "graticule/problems/mapping/relation_error.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

struct Job {
  std::string log, relations, picture;
  std::optional<double> laser_offset;
  int pieces = 1;
  double goal_m = 0;  // Cartographer's mean error (Hess et al. 2016), if known
};

constexpr double kMargin = 8, kPicturePixels = 1600;  // m about the trajectory; a side

void Draw(const LaserLog& log, const FrontEndResult& mission, const std::string& path) {
  double low_x = HUGE_VAL, low_y = HUGE_VAL, high_x = -HUGE_VAL, high_y = -HUGE_VAL;
  for (const PlanarPose& pose : mission.world_from_node) {
    low_x = std::min(low_x, pose.x - kMargin), low_y = std::min(low_y, pose.y - kMargin);
    high_x = std::max(high_x, pose.x + kMargin), high_y = std::max(high_y, pose.y + kMargin);
  }
  const double scale = kPicturePixels / std::max(high_x - low_x, high_y - low_y);
  Svg svg((high_x - low_x) * scale, (high_y - low_y) * scale);
  PathData dots(1), way(1);
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < mission.nodes.size(); ++i) {
    const PlanarPose& pose = mission.world_from_node[i];
    const LaserScan& scan = log.scans[mission.nodes[i].scan];
    points.clear();
    AppendTransformed(SurfacePoints(log, scan), pose, &points);
    for (std::size_t k = 0; k < points.size(); k += 3)
      dots.Dot((static_cast<double>(points[k].x) - low_x) * scale,
               (high_y - static_cast<double>(points[k].y)) * scale);
    const bool begins = mission.nodes[i].key.Number() == 0;
    const double x = (pose.x - low_x) * scale, y = (high_y - pose.y) * scale;
    begins ? way.MoveTo(x, y) : way.LineTo(x, y);
  }
  const Svg::Attributes ink = {
      {"stroke", "#222"}, {"stroke-width", "0.6"}, {"stroke-linecap", "round"}, {"fill", "none"}};
  svg.Path(dots, ink);
  svg.Path(way, {{"stroke", "#d33"}, {"stroke-width", "0.8"}, {"fill", "none"}});
  WriteFile(path, PngFromSvg(svg.Finish(), static_cast<int>(kPicturePixels)));
}

// The log, cut into robots of equal numbers of scans.
void Cut(LaserLog* log, int pieces) {
  const auto count = static_cast<std::size_t>(pieces);
  for (std::size_t i = 0; i < log->scans.size(); ++i)
    log->scans[i].robot = static_cast<std::uint32_t>(i * count / log->scans.size());
  for (std::size_t i = 1; i < count; ++i) log->robots.push_back("robot" + std::to_string(i + 1));
}

void Run(const Job& job) {
  Stopwatch watch;
  LaserLog log;
  CarmenOptions carmen;
  if (job.laser_offset) carmen.laser_offset = PlanarPose{*job.laser_offset, 0, 0};
  ParseCarmen(ReadFile(job.log), job.log, carmen, &log);
  const double seconds_read = watch.Lap().wall;
  const double duration = log.scans.back().time - log.scans.front().time;
  Cut(&log, job.pieces);
  const FrontEndResult mission = BuildMission(log, Builtins());
  const PhaseTime time = watch.Elapsed();
  const FrontEndReport& report = mission.report;
  fmt::print(
      "{}: {} scans in {:.0f} s; read {:.2f} s, follow {:.2f}, close {:.2f}, refine {:.2f}; wall "
      "{:.2f} s"
      " (1/{:.0f} of the log), CPU {:.2f} s\n",
      job.log.substr(job.log.rfind('/') + 1), report.scans, duration, seconds_read,
      report.seconds_follow, report.seconds_close, report.seconds_refine, seconds_read + time.wall,
      duration / (seconds_read + time.wall), time.cpu);
  fmt::print("  {} nodes, {} searches, {} closures, {} rejected, {} overlaps, {} rounds\n",
             report.nodes, report.searches, report.found - report.rejected, report.rejected,
             report.overlaps, report.rounds);
  if (job.pieces > 1) {
    fmt::print("  pieces:");
    for (const std::uint32_t piece : report.piece_of_robot) fmt::print(" {}", piece);
    fmt::print("\n");
  }
  if (!job.relations.empty()) {
    std::vector<TimedPose> poses;
    for (std::size_t i = 0; i < log.scans.size(); ++i)
      poses.push_back({log.scans[i].time, mission.world_from_scan[i]});
    const RelationError error =
        CompareWithRelations(poses, ParseRelations(ReadFile(job.relations), job.relations));
    fmt::print(
        "  {} relations ({} unmatched): {:.4f} +- {:.4f} m, {:.3f} +- {:.3f} deg; squared {:.5f}"
        " +- {:.5f} m2, {:.4f} +- {:.4f} deg2",
        error.relations, error.unmatched, error.translation_m.mean, error.translation_m.deviation,
        error.rotation_rad.mean * 180 / M_PI, error.rotation_rad.deviation * 180 / M_PI,
        error.squared_translation.mean, error.squared_translation.deviation,
        error.squared_rotation.mean * 180 / M_PI * 180 / M_PI,
        error.squared_rotation.deviation * 180 / M_PI * 180 / M_PI);
    if (job.goal_m > 0) fmt::print("; Cartographer {:.3f} m", job.goal_m);
    fmt::print("\n");
  }
  if (!job.picture.empty()) Draw(log, mission, job.picture);
}

std::vector<Job> AllSets() {
  std::vector<Job> jobs;
  const std::pair<const char*, double> sets[] = {
      {"intel", 0.023}, {"mit-killian", 0.040}, {"mit-csail", 0.032}, {"fr079", 0.045}};
  for (const auto& [name, goal_m] : sets) {
    Job job;
    job.log = std::string(GRATICULE_DATA_DIR) + "/mapping/kuemmerle/" + name + ".clf.gz";
    job.relations = std::string(GRATICULE_DATA_DIR) + "/mapping/kuemmerle/" + name + ".relations";
    job.goal_m = goal_m;
    jobs.push_back(job);
  }
  return jobs;
}

int Main(const std::vector<std::string>& words) {
  if (words.empty()) {
    for (const Job& job : AllSets()) Run(job);
    return 0;
  }
  Job job;
  job.log = words[0];
  for (std::size_t i = 1; i < words.size(); i += 2) {
    const std::string& option = words[i];
    if (i + 1 == words.size()) throw Error("expected a value of " + option, ErrorKind::kUsage);
    const std::string& value = words[i + 1];
    if (option == "--relations")
      job.relations = value;
    else if (option == "--picture")
      job.picture = value;
    else if (option == "--laser-offset")
      job.laser_offset = std::strtod(value.c_str(), nullptr);
    else if (option == "--pieces")
      job.pieces = std::max(1, std::atoi(value.c_str()));
    else
      throw Error("there is no option " + option, ErrorKind::kUsage);
  }
  Run(job);
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  try {
    return graticule::Main({argv + 1, argv + argc});
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
