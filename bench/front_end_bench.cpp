#include <fmt/core.h>

#include <cstdlib>
#include <cstring>

#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/relations.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/mapping/front_end.hpp"
#include "graticule/problems/mapping/relation_error.hpp"
#include "graticule/solver/stopwatch.hpp"

using namespace graticule;

static void Draw(const std::vector<TrackNode>& nodes, const std::string& path) {
  double lx = 1e9, ly = 1e9, hx = -1e9, hy = -1e9;
  for (const auto& n : nodes) {
    lx = std::min(lx, n.pose.x), ly = std::min(ly, n.pose.y);
    hx = std::max(hx, n.pose.x), hy = std::max(hy, n.pose.y);
  }
  lx -= 10, ly -= 10, hx += 10, hy += 10;
  const double k = 1600 / std::max(hx - lx, hy - ly);
  Svg svg((hx - lx) * k, (hy - ly) * k);
  PathData dots(1), line(1);
  bool first = true;
  for (const auto& n : nodes) {
    std::vector<SurfacePoint> w;
    AppendTransformed(n.points, n.pose, &w);
    for (std::size_t i = 0; i < w.size(); i += 3)
      dots.Dot((static_cast<double>(w[i].x) - lx) * k, (hy - static_cast<double>(w[i].y)) * k);
    if (first) line.MoveTo((n.pose.x - lx) * k, (hy - n.pose.y) * k);
    else line.LineTo((n.pose.x - lx) * k, (hy - n.pose.y) * k);
    first = false;
  }
  svg.Path(dots, {{"stroke", "#222"}, {"stroke-width", "0.8"}, {"stroke-linecap", "round"}, {"fill", "none"}});
  svg.Path(line, {{"stroke", "#d33"}, {"stroke-width", "1"}, {"fill", "none"}});
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
    const auto track = FollowScans(log, o);
    const auto& nodes = track.nodes;
    const double s = watch.Elapsed().cpu;
    fmt::print("{} nodes {:.3f} ms/scan\n", nodes.size(), s * 1e3 / double(log.scans.size()));
    const auto poses = ScanPoses(log, track.scan_poses);
    Print("sequential", CompareWithRelations(poses, rel), s);
    std::vector<PoseRelation> shorts;
    for (auto& r : rel) if (std::abs(r.time_b - r.time_a) < 15) shorts.push_back(r);
    Print("short odom", CompareWithRelations(odom, shorts), s);
    Print("short", CompareWithRelations(poses, shorts), s);
    Draw(nodes, "/tmp/mapfront_" + set + ".png");
  }
}
