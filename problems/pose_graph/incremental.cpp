#include "graticule/problems/pose_graph/incremental.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/problems/pose_graph/replay.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

bool IsFinite(const Values& values) {
  return std::all_of(values.Data().begin(), values.Data().end(),
                     [](double value) { return std::isfinite(value); });
}

class Growing {
 public:
  Growing(const Graph& graph, const IncrementalOptions& options)
      : options_(options), online_(graph.Types(), options.online), replay_(graph, &online_) {}

  bool IsDone() const { return replay_.IsDone(); }

  // The next poses, up to where an update is due, and the update.
  void Step() {
    const double linear = options_.online.relinearise_above * options_.online.relinearise_above;
    double turn_variance = 0;
    for (int poses = 0; !IsDone(); ++poses) {
      const bool is_due = poses >= options_.poses_an_update || turn_variance > linear;
      if (is_due && eliminated_ <= options_.work * come_) break;
      replay_.Next();
      turn_variance += replay_.TurnVariance();
      ++come_;
    }
    eliminated_ += static_cast<double>(online_.Update().eliminated);
  }

  Replay& TheReplay() { return replay_; }

 private:
  const IncrementalOptions& options_;
  Online online_;
  Replay replay_;
  double eliminated_ = 0, come_ = 0;
};

}  // namespace

IncrementalReport PlaceIncrementally(const Graph& graph, Values* values,
                                     const IncrementalOptions& options, const Observer& watch) {
  const Stopwatch clock;
  IncrementalReport report;
  Growing growing(graph, options);
  try {
    while (!growing.IsDone() && report.is_complete) {
      growing.Step();
      Iteration row;
      row.number = static_cast<int>(++report.updates);
      row.objective = std::numeric_limits<double>::quiet_NaN();
      row.seconds = clock.Elapsed().wall;
      report.is_complete = !watch.on_iteration || watch.on_iteration(row);
    }
  } catch (const Error& error) {
    report.is_complete = false;
    report.failure = error.what();
  }
  Replay& replay = growing.TheReplay();
  replay.PlaceTheRest();
  const Values placed = replay.Current();
  if (!IsFinite(placed)) {
    report.is_complete = false;
    report.failure = "the values grew out of bounds";
    return report;
  }
  *values = placed;
  report.poses = replay.Poses();
  report.roots = replay.Roots();
  report.free_roots = replay.FreeRoots();
  report.landmarks = {replay.Landmarks(), replay.Assumed()};
  return report;
}

}  // namespace graticule
