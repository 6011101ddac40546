// Replays a recorded sequence of graphs through the live map, by each method: how long an update
// takes, and how far the map is from that of all nodes.

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "graticule/io/file.hpp"
#include "graticule/io/g2o_laser.hpp"
#include "graticule/io/pose_sequence.hpp"
#include "graticule/problems/mapping/live_map.hpp"
#include "graticule/problems/mapping/map_error.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Mission {
  G2oLaser laser;
  PoseSequence sequence;
};

struct Replay {
  std::vector<double> cpu, wall;  // s, an update
  std::size_t regenerated_nodes = 0, cover = 0, left_over = 0, graphs_with_left_over = 0;
  std::size_t dirty = 0, flips = 0;
  std::size_t over_deadline = 0;  // updates, by CPU time: other programs preempt this one
  std::shared_ptr<const OccupancyMap> map;
};

double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

NodeId AddNode(const Mission& mission, const PoseSequence::Pose& pose, LiveMap* map) {
  const LaserLog& log = mission.laser.log;
  const LaserScan& scan = log.scans[pose.node];
  return map->AddNode(mission.sequence.RobotOf(pose.node), log.GeometryOf(scan), log.RangesOf(scan),
                      pose.world_from_robot);
}

Replay Run(const Mission& mission, const LiveMapOptions& options, double deadline) {
  LiveMap map(options);
  constexpr NodeId kNew = static_cast<NodeId>(-1);
  std::vector<NodeId> ids(mission.sequence.nodes, kNew);
  Replay replay;
  const auto update = [&](double began) {
    const double update_began = ThreadSeconds();
    const MapUpdate report = map.Update(deadline);
    const double ended = ThreadSeconds();
    replay.cpu.push_back(ended - began);
    replay.over_deadline += ended - update_began > deadline;
    replay.wall.push_back(report.seconds);
    replay.regenerated_nodes += report.regenerated_nodes;
    replay.cover = report.cover;
    replay.left_over += report.left_over.size();
    replay.graphs_with_left_over += !report.left_over.empty() || !report.waiting.empty();
    replay.dirty += report.change.dirty_tiles;
    replay.flips += report.change.flips.size();
    return report.left_over.empty() && report.waiting.empty();
  };
  bool finished = true;
  for (std::size_t g = 0; g < mission.sequence.GraphCount(); ++g) {
    const double began = ThreadSeconds();
    for (const PoseSequence::Pose& pose : mission.sequence.Graph(g)) {
      NodeId& id = ids[pose.node];
      if (id == kNew)
        id = AddNode(mission, pose, &map);
      else
        map.UpdatePose(id, pose.world_from_robot);
    }
    finished = update(began);
  }
  int more = 0;
  for (; !finished && more < 10000; ++more) finished = update(ThreadSeconds());
  if (more > 0) fmt::print("  ({} more updates finished what was left over)\n", more);
  replay.map = map.Map();
  return replay;
}

// Of all labels: equal maps have equal ones.
std::uint64_t Digest(const OccupancyGrid& grid) {
  std::uint64_t digest = 14695981039346656037u;  // FNV-1a
  for (const Occupancy cell : grid.cells)
    digest = (digest ^ static_cast<std::uint64_t>(cell)) * 1099511628211u;
  return digest;
}

// All nodes where the last graph has them.
std::shared_ptr<const OccupancyMap> Reference(const Mission& mission, LiveMapOptions options) {
  options.method = MapMethod::kNaive;
  LiveMap map(options);
  std::vector<PoseSequence::Pose> last(mission.sequence.nodes);
  for (const PoseSequence::Pose& pose : mission.sequence.poses) last[pose.node] = pose;
  for (const PoseSequence::Pose& pose : last) AddNode(mission, pose, &map);
  map.Update();
  return map.Map();
}

void Print(const std::string& name, Replay replay, const OccupancyMap& reference) {
  double total = 0;
  for (const double s : replay.cpu) total += s;
  std::size_t bands[5] = {};
  constexpr double kBands[] = {0.5e-3, 1e-3, 5e-3, 20e-3};
  for (const double s : replay.cpu)
    ++bands[std::upper_bound(std::begin(kBands), std::end(kBands), s) - std::begin(kBands)];
  std::sort(replay.cpu.begin(), replay.cpu.end());
  const auto n = replay.cpu.size();
  const OccupancyGrid grid = replay.map->Grid();
  const MapAgreement agreement = CompareMaps(reference.Grid(), grid);
  fmt::print(
      "{:16} total {:8.4f} s, mean {:8.4f} ms, p99 {:8.3f}, worst {:8.3f} (wall {:8.3f}); graphs < "
      "0.5, 1, 5, 20 ms, above: {} {} {} {} {}; cover {}, drawn anew {}, dirty {}, flips {}\n"
      "{:16} against all nodes: structure IoU {:.4f}, free IoU {:.4f}, known recall {:.4f}, "
      "other label {:.4f}; digest {:016x}\n",
      name, total, 1e3 * total / static_cast<double>(n), 1e3 * replay.cpu[n * 99 / 100],
      1e3 * replay.cpu.back(), 1e3 * *std::max_element(replay.wall.begin(), replay.wall.end()),
      bands[0], bands[1], bands[2], bands[3], bands[4], replay.cover, replay.regenerated_nodes,
      replay.dirty, replay.flips, "", agreement.Iou(Occupancy::kStructure),
      agreement.Iou(Occupancy::kFree), agreement.KnownRecall(), agreement.KnownChanged(),
      Digest(grid));
  if (replay.left_over > 0)
    fmt::print("{:16} slices left over {}, in {} graphs; updates over the deadline {}\n", "",
               replay.left_over, replay.graphs_with_left_over, replay.over_deadline);
}

int Main(int argc, char** argv) {
  const std::map<std::string, MapMethod> methods_known(MapMethodNames().begin(),
                                                       MapMethodNames().end());
  Mission mission;
  mission.laser = ParseG2oLaser(ReadFile(argv[1]), argv[1]);
  mission.sequence = ParsePoseSequence(ReadFile(argv[2]), argv[2]);
  if (mission.laser.log.scans.size() != mission.sequence.nodes)
    throw Error(std::string(argv[2]) + ": expected as many nodes as there are scans");
  LiveMapOptions options;
  double deadline = std::numeric_limits<double>::infinity();
  std::vector<std::string> methods;
  for (int i = 3; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const double value = equals == std::string::npos ? 1 : std::atof(word.c_str() + equals + 1);
    const int whole = static_cast<int>(value);
    if (methods_known.count(name))
      methods.push_back(name);
    else if (name == "slice")
      options.slice_size = static_cast<std::size_t>(whole);
    else if (name == "resolution")
      options.resolution = value;
    else if (name == "max-range")
      options.ranges.max_range = value;
    else if (name == "clear-no-return")
      options.ranges.clear_no_return = whole != 0;
    else if (name == "cover")
      options.cover.on = whole != 0;
    else if (name == "news")
      options.cover.news = value;
    else if (name == "views")
      options.cover.views = whole;
    else if (name == "across")
      options.cover.across_robots = whole != 0;
    else if (name == "threshold")
      options.regenerate_above = value;
    else if (name == "hit-votes")
      options.votes.hit_votes = whole;
    else if (name == "pass-votes")
      options.votes.pass_votes = whole;
    else if (name == "bias")
      options.votes.bias = whole;
    else if (name == "saturation")
      options.votes.saturation = whole;
    else if (name == "threads")
      options.threads = whole;
    else if (name == "deadline")
      deadline = 1e-3 * value;
    else
      throw Error("unknown word '" + word + "'", ErrorKind::kUsage);
  }
  const auto reference = Reference(mission, options);
  for (const std::string& method : methods) {
    options.method = methods_known.at(method);
    Print(method, Run(mission, options, deadline), *reference);
  }
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(
        stderr,
        "usage: graticule_mapping_replay SCANS.g2o SEQUENCE.pgseq METHOD... [NAME=VALUE...]\n"
        "methods: naive naive-cover cover-composite incremental\n");
    return 2;
  }
  try {
    return graticule::Main(argc, argv);
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "graticule_mapping_replay: {}\n", error.what());
    return 1;
  }
}
