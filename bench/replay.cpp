// Replays a recorded pose graph pose by pose: how long a step takes, and where it ends.

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/pose_graph/replay.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

int Run(const std::string& file, OnlineOptions options, int exact_every) {
  const Graph recorded = ReadProblem(file, Builtins(), {}).graph;
  Online online(Builtins(), options);
  Replay replay(recorded, &online);
  std::vector<double> seconds;
  double cpu = 0;
  std::size_t eliminated = 0, relinearised = 0;
  double exact_seconds = 0;
  while (!replay.IsDone()) {
    const Stopwatch clock;
    replay.Next();
    const OnlineReport report = online.Update();
    const PhaseTime time = clock.Elapsed();
    seconds.push_back(time.wall);
    cpu += time.cpu;
    eliminated += report.eliminated;
    relinearised += report.relinearised;
    if (exact_every > 0 && seconds.size() % static_cast<std::size_t>(exact_every) == 0) {
      const Stopwatch exact;
      online.UpdateExactly();
      exact_seconds += exact.Elapsed().wall;
    }
  }
  double total = 0;
  for (const double s : seconds) total += s;
  const auto objective = [&] {
    const Graph problem = online.Problem();
    const Values values = problem.InitialValues();
    return Objectives(problem, {&values})[0];
  };
  const double left = objective();
  const Stopwatch clock;
  online.UpdateExactly();
  const double last = clock.Elapsed().wall;
  std::sort(seconds.begin(), seconds.end());
  fmt::print(
      "{}: {} steps, {:.3f} s in all ({:.3f} of CPU), mean {:.3f} ms, median {:.3f}, 99 % {:.3f}, "
      "worst {:.3f}; "
      "{:.1f} variables eliminated a step, {:.1f} relinearised; cost {:.9g}, then {:.9g} by an "
      "exact update of {:.1f} ms\n",
      file, seconds.size(), total, cpu, 1e3 * total / static_cast<double>(seconds.size()),
      1e3 * seconds[seconds.size() / 2], 1e3 * seconds[seconds.size() * 99 / 100],
      1e3 * seconds.back(), static_cast<double>(eliminated) / static_cast<double>(seconds.size()),
      static_cast<double>(relinearised) / static_cast<double>(seconds.size()), left, objective(),
      1e3 * last);
  if (exact_every > 0) fmt::print("exact updates on the way: {:.3f} s\n", exact_seconds);
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  if (argc < 2) {
    fmt::print(stderr, "usage: graticule_replay FILE [relinearise_above [every [propagate]]]\n");
    return 2;
  }
  OnlineOptions options;
  if (argc > 2) options.relinearise_above = std::atof(argv[2]);
  if (argc > 3) options.relinearise_every = std::atoi(argv[3]);
  if (argc > 4) options.propagate_above = std::atof(argv[4]);
  try {
    return Run(argv[1], options, argc > 5 ? std::atoi(argv[5]) : 0);
  } catch (const Error& error) {
    fmt::print(stderr, "graticule_replay: {}\n", error.what());
    return 1;
  }
}
