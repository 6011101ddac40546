#include <fmt/core.h>

#include <cstdlib>
#include <cstring>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/relations.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/mapping/front_end.hpp"
#include "graticule/problems/mapping/relation_error.hpp"
#include "graticule/solver/stopwatch.hpp"

using namespace graticule;

static void Draw(const LaserLog& log, const FrontEndResult& m, const std::string& path) {
  double lx = 1e9, ly = 1e9, hx = -1e9, hy = -1e9;
  for (const auto& n : m.world_from_node) {
    lx = std::min(lx, n.x), ly = std::min(ly, n.y);
    hx = std::max(hx, n.x), hy = std::max(hy, n.y);
  }
  lx -= 10, ly -= 10, hx += 10, hy += 10;
  const double k = 2000 / std::max(hx - lx, hy - ly);
  Svg svg((hx - lx) * k, (hy - ly) * k);
  PathData dots(1), line(1);
  bool first = true;
  for (std::size_t i = 0; i < m.nodes.size(); ++i) {
    std::vector<SurfacePoint> w;
    AppendTransformed(SurfacePoints(log, log.scans[m.nodes[i].scan]), m.world_from_node[i], &w);
    for (std::size_t j = 0; j < w.size(); j += 4)
      dots.Dot((static_cast<double>(w[j].x) - lx) * k, (hy - static_cast<double>(w[j].y)) * k);
    const auto& p = m.world_from_node[i];
    if (first) line.MoveTo((p.x - lx) * k, (hy - p.y) * k);
    else line.LineTo((p.x - lx) * k, (hy - p.y) * k);
    first = false;
  }
  svg.Path(dots, {{"stroke", "#222"}, {"stroke-width", "0.6"}, {"stroke-linecap", "round"}, {"fill", "none"}});
  svg.Path(line, {{"stroke", "#d33"}, {"stroke-width", "0.7"}, {"fill", "none"}});
  WriteFile(path, PngFromSvg(svg.Finish(), 1600));
}

static std::vector<TimedPose> ScanPoses(const LaserLog& log, const std::vector<PlanarPose>& scans) {
  std::vector<TimedPose> poses;
  for (std::size_t i = 0; i < scans.size(); ++i) poses.push_back({log.scans[i].time, scans[i]});
  return poses;
}

static void Print(const char* label, const RelationError& e, double s) {
  fmt::print("{:>12}: {} rel ({} unmatched) trans {:.4f} +- {:.4f}  rot {:.4f} +- {:.4f} deg   {:.2f} s\n", label,
             e.relations, e.unmatched, e.translation_m.mean, e.translation_m.deviation,
             e.rotation_rad.mean * 180 / M_PI, e.rotation_rad.deviation * 180 / M_PI, s);
}

int main(int argc, char** argv) {
  setvbuf(stdout, nullptr, _IOLBF, 0);
  FrontEndOptions o;
  if (getenv("LN")) o.local_nodes = atoi(getenv("LN"));
  if (getenv("SP")) o.point_spacing = atof(getenv("SP"));
  if (getenv("MR")) o.max_range = atof(getenv("MR"));
  if (getenv("ND")) o.node_distance = atof(getenv("ND"));
  for (int i = 1; i < argc; ++i) {
    const std::string set = argv[i];
    const std::string base = std::string(GRATICULE_DATA_DIR) + "/mapping/kuemmerle/" + set;
    Stopwatch watch;
    LaserLog log;
    ParseCarmen(ReadFile(base + ".clf.gz"), set, {}, &log);
    const auto rel = ParseRelations(ReadFile(base + ".relations"), set);
    fmt::print("{}: {} scans, {} robots, {} geometries max {} read in {:.2f} s\n", set, log.scans.size(), log.robots.size(), log.geometries.size(), log.geometries[0].max_range, watch.Elapsed().wall);
    std::vector<TimedPose> odom;
    for (auto& s : log.scans) odom.push_back({s.time, s.odom_from_robot});
    Print("odometry", CompareWithRelations(odom, rel), 0);
    watch.Restart();
    if (getenv("CR")) o.closure_rounds = atoi(getenv("CR"));
    if (getenv("OR")) o.overlap_rounds = atoi(getenv("OR"));
    const FrontEndResult mission = BuildMission(log, Builtins(), o);
    const double s = watch.Elapsed().wall;
    const auto& r = mission.report;
    fmt::print("{} nodes, {} searches, {} found, {} rejected, {} overlaps; follow {:.2f} close {:.2f} refine {:.2f} s cpu {:.2f}\n", r.nodes, r.searches, r.found, r.rejected, r.overlaps, r.seconds_follow, r.seconds_close, r.seconds_refine, watch.Elapsed().cpu);
    const auto poses = ScanPoses(log, mission.world_from_scan);
    Print("all", CompareWithRelations(poses, rel), s);
    std::vector<PoseRelation> shorts;
    for (auto& q : rel) if (std::abs(q.time_b - q.time_a) < 15) shorts.push_back(q);
    if (getenv("DUMP")) {
      FILE* f = fopen(("/tmp/mapfront_poses_" + set + ".txt").c_str(), "w");
      for (std::size_t i = 0; i < poses.size(); ++i) fprintf(f, "%.6f %.6f %.6f %.6f %.6f %.6f %.6f\n", poses[i].time, poses[i].world_from_robot.x, poses[i].world_from_robot.y, poses[i].world_from_robot.yaw, odom[i].world_from_robot.x, odom[i].world_from_robot.y, odom[i].world_from_robot.yaw);
      fclose(f);
    }
    Print("short odom", CompareWithRelations(odom, shorts), s);
    Print("short", CompareWithRelations(poses, shorts), s);
    Draw(log, mission, "/tmp/mapfront_" + set + ".png");
  }
}
