// Replays a recorded pose graph pose by pose: how long a step takes, and where it ends.

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

// Where a new pose is, by a factor that joins it to one that is known.
bool Predict(const FactorView& factor, VariableId pose, const Values& latest,
             std::vector<double>* value) {
  if (factor.variables.size() != 2 || factor.measurement.size() != value->size()) return false;
  const bool planar = value->size() == 3;
  const VariableId other = factor.variables[factor.variables[0] == pose ? 1 : 0];
  if (other >= pose) return false;
  double a_from_b[7];
  if (factor.variables[1] == pose)
    CopyPose(planar, factor.measurement.data(), a_from_b);
  else
    Invert(planar, factor.measurement.data(), a_from_b);
  Compose(planar, latest[other].data(), a_from_b, value->data());
  return true;
}

int Run(const std::string& file, OnlineOptions options, int exact_every) {
  Graph recorded = ReadProblem(file, Builtins(), {}).graph;
  // Poses as a robot meets them: in the order of their keys.
  const std::vector<VariableId> order = recorded.KeyOrder();
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  std::vector<std::vector<FactorId>> arrivals(order.size());
  for (FactorId id = 0; id < recorded.FactorCount(); ++id) {
    std::size_t last = 0;
    for (const VariableId variable : recorded.VariablesOf(id))
      last = std::max(last, place[variable]);
    arrivals[last].push_back(id);
  }

  Online online(Builtins(), options);
  std::vector<double> seconds;
  double cpu = 0;
  std::size_t eliminated = 0, relinearised = 0;
  double exact_seconds = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const VariableId pose = order[i];
    std::vector<double> value(recorded.ValueOf(pose).begin(), recorded.ValueOf(pose).end());
    const Stopwatch clock;
    const auto latest = online.Latest();
    for (const FactorId id : arrivals[i]) {
      FactorView factor = recorded.FactorAt(id);
      std::vector<VariableId> places;
      for (const VariableId variable : factor.variables)
        places.push_back(static_cast<VariableId>(place[variable]));
      factor.variables = {places.data(), places.size()};
      if (latest && Predict(factor, static_cast<VariableId>(i), *latest, &value)) break;
    }
    online.Add(recorded.KeyOf(pose), recorded.TypeOf(pose).name, value);
    for (const FactorId id : arrivals[i]) online.Add(recorded.FactorRecord(id));
    const OnlineReport report = online.Update();
    const PhaseTime time = clock.Elapsed();
    seconds.push_back(time.wall);
    cpu += time.cpu;
    eliminated += report.eliminated;
    relinearised += report.relinearised;
    if (exact_every > 0 && (i + 1) % static_cast<std::size_t>(exact_every) == 0) {
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
