// What an update of the live map costs as a mission grows longer, its area larger, its team bigger:
// a row of a Markdown table each, and a plot (docs/mapping.md).
//
//   graticule_mapping_scaling length|area|robots [PLOT.svg]
//
// Simulated towns of three seeds each; a graph every 10 s; one thread, CPU time, adding nodes and
// poses included; of three replays the shortest time of each update.

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/chart.hpp"
#include "graticule/io/file.hpp"
#include "graticule/problems/mapping/map_mission.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"
#include "graticule/problems/mapping/simulate.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

constexpr double kGraphEvery = 10;  // s, as the thesis
constexpr std::uint64_t kSeeds = 3;
constexpr int kReplays = 3;

struct Update {
  double time = 0;                                      // s, since the mission began
  double seconds = std::numeric_limits<double>::max();  // CPU
  std::size_t nodes = 0, cover = 0, taken = 0, drawn_anew = 0;
};

struct Replayed {
  std::vector<Update> updates;
  std::vector<double> naive_at, naive_seconds;  // all nodes drawn at once: when, CPU
};

void Replay(const Mission& mission, const std::vector<MissionStep>& steps,
            std::vector<Update>* updates) {
  LiveMap map;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const MissionStep& step = steps[i];
    const std::size_t before = map.NodeCount();
    const Stopwatch clock;
    for (std::size_t node = 0; node < step.nodes; ++node) {
      const LaserScan& scan = mission.log.scans[mission.nodes[node].scan];
      if (node < before)
        map.UpdatePose(static_cast<NodeId>(node), step.world_from_robot[node]);
      else
        map.AddNode(scan.robot, mission.log.GeometryOf(scan), mission.log.RangesOf(scan),
                    step.world_from_robot[node]);
    }
    const MapUpdate done = map.Update();
    Update& update = (*updates)[i];
    update.seconds = std::min(update.seconds, clock.Elapsed().cpu);
    update.time = step.time - steps.front().time;
    update.nodes = done.nodes;
    update.cover = done.cover;
    update.taken = done.nodes - before;
    update.drawn_anew = done.regenerated_nodes;
  }
}

// Of the last step of every `naive_every` seconds.
void DrawAll(const Mission& mission, const std::vector<MissionStep>& steps, double naive_every,
             Replayed* replayed) {
  double next = naive_every;
  for (const MissionStep& step : steps) {
    const double time = step.time - steps.front().time;
    if (time < next && &step != &steps.back()) continue;
    next += naive_every;
    const Stopwatch clock;
    MapOfAllNodes(mission, step, {});
    replayed->naive_at.push_back(time);
    replayed->naive_seconds.push_back(clock.Elapsed().cpu);
  }
}

Replayed ReplayedOf(MissionOptions options, std::uint64_t seed, double naive_every) {
  options.seed = options.town.seed = seed;
  const SimulatedMission simulated = SimulateMission(Builtins(), options);
  MissionReplay replay(simulated.mission, kGraphEvery);
  std::vector<MissionStep> steps;
  for (MissionStep step; replay.Next(&step);) steps.push_back(step);
  Replayed replayed;
  replayed.updates.resize(steps.size());
  for (int i = 0; i < kReplays; ++i) Replay(simulated.mission, steps, &replayed.updates);
  DrawAll(simulated.mission, steps, naive_every, &replayed);
  return replayed;
}

// A point of the plots: updates of all seeds.
struct Row {
  double x = 0;
  std::string name;
  std::vector<Update> updates;
  double naive = 0;  // s, the mean of the seeds
};

double Mean(const Row& row, double (*of)(const Update&)) {
  double sum = 0;
  for (const Update& update : row.updates) sum += of(update);
  return sum / static_cast<double>(std::max<std::size_t>(row.updates.size(), 1));
}

double MedianSeconds(const Row& row) {
  std::vector<double> seconds;
  for (const Update& update : row.updates) seconds.push_back(update.seconds);
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<long>(seconds.size() / 2),
                   seconds.end());
  return seconds[seconds.size() / 2];
}

MissionOptions Plain() {
  MissionOptions options;  // 100 x 80 m, 4 robots
  options.duration_s = 900;
  return options;
}

void AddBetween(const Replayed& replayed, double from, double to, Row* row) {
  for (const Update& update : replayed.updates)
    if (update.time > from && update.time <= to) row->updates.push_back(update);
  for (std::size_t i = 0; i < replayed.naive_at.size(); ++i)
    if (replayed.naive_at[i] > from && replayed.naive_at[i] <= to)
      row->naive += replayed.naive_seconds[i] / static_cast<double>(kSeeds);
}

// Twelve stretches of one long mission in a fixed area.
std::vector<Row> ByLength() {
  constexpr double kStretch = 600;
  constexpr int kStretches = 12;
  std::vector<Row> rows(kStretches);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    MissionOptions options = Plain();
    options.duration_s = kStretch * kStretches;
    const Replayed replayed = ReplayedOf(options, seed, kStretch);
    for (int i = 0; i < kStretches; ++i) {
      Row& row = rows[static_cast<std::size_t>(i)];
      row.x = kStretch * (i + 1) / 60;
      row.name = fmt::format("{:.0f} to {:.0f} min", kStretch * i / 60, row.x);
      AddBetween(replayed, kStretch * i, kStretch * (i + 1), &row);
    }
  }
  return rows;
}

// The second half of missions of 15 minutes.
std::vector<Row> ByMission(bool by_area) {
  std::vector<Row> rows;
  for (const int factor : {1, 2, 4, 8}) {
    MissionOptions options = Plain();
    Row row;
    if (by_area) {
      options.town.width_m = 60 * factor;
      row.x = options.town.width_m * options.town.height_m;
      row.name = fmt::format("{:.0f} m²", row.x);
    } else {
      options.robots = 2 * factor;
      row.x = options.robots;
      row.name = fmt::format("{}", options.robots);
    }
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
      AddBetween(ReplayedOf(options, seed, options.duration_s), options.duration_s / 2,
                 options.duration_s, &row);
    rows.push_back(std::move(row));
  }
  return rows;
}

int Main(const std::string& what, const std::string& plot) {
  const std::vector<Row> rows = what == "length" ? ByLength() : ByMission(what == "area");
  fmt::print(
      "| {} | nodes | cover | new nodes, drawn anew: an update | mean [ms] | median | worst | all "
      "nodes at once |\n",
      what);
  CurveChart chart;
  chart.title = what == "length"
                    ? "An update against the length of the mission (100 x 80 m, 4 robots)"
                : what == "area" ? "An update against the area (4 robots)"
                                 : "An update against the number of robots (100 x 80 m)";
  chart.x_label = what == "length" ? "time of the mission [min]"
                  : what == "area" ? "area [m²]"
                                   : "robots";
  chart.y_label = "CPU time [ms]";
  chart.y_scale = AxisScale::kLogarithmic;
  chart.curves = {{"mean", {}}, {"median", {}}, {"naive: all nodes at once", {}}};
  for (const Row& row : rows) {
    const double mean = 1e3 * Mean(row, [](const Update& u) { return u.seconds; });
    const double median = 1e3 * MedianSeconds(row);
    double worst = 0;
    for (const Update& update : row.updates) worst = std::max(worst, 1e3 * update.seconds);
    const auto count = [&](auto of) { return Mean(row, of); };
    fmt::print("| {} | {:.0f} | {:.0f} | {:.1f}, {:.1f} | {:.2f} | {:.2f} | {:.0f} | {:.0f} |\n",
               row.name, count([](const Update& u) { return static_cast<double>(u.nodes); }),
               count([](const Update& u) { return static_cast<double>(u.cover); }),
               count([](const Update& u) { return static_cast<double>(u.taken); }),
               count([](const Update& u) { return static_cast<double>(u.drawn_anew); }), mean,
               median, worst, 1e3 * row.naive);
    chart.curves[0].points.push_back({row.x, mean});
    chart.curves[1].points.push_back({row.x, median});
    chart.curves[2].points.push_back({row.x, 1e3 * row.naive});
  }
  if (!plot.empty()) WriteFile(plot, DrawCurves(chart));
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  try {
    if (argc <= 3 && (what == "length" || what == "area" || what == "robots"))
      return graticule::Main(what, argc > 2 ? argv[2] : "");
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "graticule_mapping_scaling: {}\n", error.what());
    return 1;
  }
  fmt::print(stderr, "usage: graticule_mapping_scaling length|area|robots [PLOT.svg]\n");
  return 2;
}
