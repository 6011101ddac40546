// Replays a recorded pose graph pose by pose: how long a step takes, and where it ends.  With a
// lag, loop closures onto poses that have left are passed over, and counted; the trajectory is then
// compared with the whole graph's solution.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <variant>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/pose_graph/replay.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

// What is to be replayed, and how.
struct Wanted {
  std::string file;
  OnlineOptions options;
  std::size_t lag = 0;          // poses of each family that stay; 0: all
  std::size_t exact_every = 0;  // steps; 0: at the end only
};

struct Times {
  std::vector<double> seconds;  // of each step, wall
  double cpu = 0, exact = 0;

  void Print(const std::string& file) const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    double total = 0;
    for (const double s : seconds) total += s;
    const std::size_t count = seconds.size();
    fmt::print(
        "{}: {} steps, {:.3f} s in all ({:.3f} of CPU), mean {:.3f} ms, median {:.3f}, 99 % "
        "{:.3f}, "
        "worst {:.3f}\n",
        file, count, total, cpu, 1e3 * total / static_cast<double>(count), 1e3 * sorted[count / 2],
        1e3 * sorted[count * 99 / 100], 1e3 * sorted.back());
    fmt::print("mean by tenths of the way [ms]:");
    for (std::size_t tenth = 0; tenth < 10; ++tenth) {
      const std::size_t begin = count * tenth / 10, end = count * (tenth + 1) / 10;
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) sum += seconds[i];
      fmt::print(" {:.3f}", 1e3 * sum / static_cast<double>(std::max<std::size_t>(end - begin, 1)));
    }
    fmt::print("\n");
  }
};

// Root mean square distance [m] of the poses of a graph in two sets of values, seen from the first
// of them.
double RmsDistance(const Graph& graph, const Values& a, const Values& b) {
  const std::vector<VariableId> order = graph.KeyOrder();
  const bool planar = graph.TypeOf(order[0]).Size() == 3;
  double a_from_world[7], b_from_world[7], in_a[7], in_b[7];
  Invert(planar, a.At(graph.KeyOf(order[0])).data(), a_from_world);
  Invert(planar, b.At(graph.KeyOf(order[0])).data(), b_from_world);
  double sum = 0;
  for (const VariableId id : order) {
    Compose(planar, a_from_world, a.At(graph.KeyOf(id)).data(), in_a);
    Compose(planar, b_from_world, b.At(graph.KeyOf(id)).data(), in_b);
    for (int i = 0; i < (planar ? 2 : 3); ++i) sum += (in_a[i] - in_b[i]) * (in_a[i] - in_b[i]);
  }
  return std::sqrt(sum / static_cast<double>(order.size()));
}

double ObjectiveOf(const Graph& problem) {
  const Values values = problem.InitialValues();
  return Objectives(problem, {&values})[0];
}

// Fixed lag beside the minimum of the same factors, all at once.
void CompareWithBatch(const Online& online, std::size_t passed_over) {
  const Graph recorded = online.Recorded();
  const Values batch = Solve(recorded).values;
  const Graph window = online.Problem();
  const Key last = window.KeyOf(window.KeyOrder().back());
  const auto marginals = ComputeMarginals(recorded, batch, {last}, false);
  const auto* known = std::get_if<Marginals>(&marginals);
  fmt::print(
      "{} factors onto poses that had left were passed over; the {} poses of the window, seen from "
      "its first, are {:.4f} m (rms) from the minimum of all other factors; the last pose's "
      "standard "
      "deviation along its x is {:.3f} m, there {:.3f} m\n",
      passed_over, window.VariableCount(), RmsDistance(window, *online.Latest(), batch),
      std::sqrt(online.Covariance(last)[0]),
      known ? std::sqrt(known->Covariance(last, last)[0]) : std::nan(""));
}

int Run(const Wanted& wanted) {
  const Graph recorded = ReadProblem(wanted.file, Builtins(), {}).graph;
  OnlineOptions options = wanted.options;
  for (VariableId id = 0; id < recorded.VariableCount() && wanted.lag > 0; ++id)
    if (IsPose(recorded.TypeOf(id)))
      options.lag[std::string(recorded.KeyOf(id).Family())] = wanted.lag;
  Online online(Builtins(), options);
  Replay replay(recorded, &online);
  Times times;
  std::size_t eliminated = 0, relinearised = 0;
  while (!replay.IsDone()) {
    const Stopwatch clock;
    replay.Next();
    const OnlineReport report = online.Update();
    const PhaseTime time = clock.Elapsed();
    times.seconds.push_back(time.wall);
    times.cpu += time.cpu;
    eliminated += report.eliminated;
    relinearised += report.relinearised;
    if (wanted.exact_every > 0 && times.seconds.size() % wanted.exact_every == 0) {
      const Stopwatch exact;
      online.UpdateExactly();
      times.exact += exact.Elapsed().wall;
    }
  }
  const double left = ObjectiveOf(online.Problem());
  const Stopwatch clock;
  online.UpdateExactly();
  const double last = clock.Elapsed().wall;
  times.Print(wanted.file);
  const auto steps = static_cast<double>(times.seconds.size());
  fmt::print(
      "{:.1f} variables eliminated a step, {:.1f} relinearised; cost {:.9g}, then {:.9g} by an "
      "exact "
      "update of {:.1f} ms\n",
      static_cast<double>(eliminated) / steps, static_cast<double>(relinearised) / steps, left,
      ObjectiveOf(online.Problem()), 1e3 * last);
  if (wanted.exact_every > 0) fmt::print("exact updates on the way: {:.3f} s\n", times.exact);
  if (wanted.lag > 0) CompareWithBatch(online, replay.PassedOver());
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  Wanted wanted;
  bool is_understood = argc >= 2 && argc % 2 == 0;
  if (is_understood) wanted.file = argv[1];
  for (int i = 2; i + 1 < argc && is_understood; i += 2) {
    const std::string name = argv[i];
    const double number = std::atof(argv[i + 1]);
    if (name == "above")
      wanted.options.relinearise_above = number;
    else if (name == "every")
      wanted.options.relinearise_every = static_cast<int>(number);
    else if (name == "propagate")
      wanted.options.propagate_above = number;
    else if (name == "lag")
      wanted.lag = static_cast<std::size_t>(number);
    else if (name == "exact-every")
      wanted.exact_every = static_cast<std::size_t>(number);
    else
      is_understood = false;
  }
  if (!is_understood) {
    fmt::print(stderr,
               "usage: graticule_replay FILE [above M] [every STEPS] [propagate M] [lag POSES] "
               "[exact-every STEPS]\n");
    return 2;
  }
  try {
    return Run(wanted);
  } catch (const Error& error) {
    fmt::print(stderr, "graticule_replay: {}\n", error.what());
    return 1;
  }
}
