// Time by phase on recorded problems: load, build, solve, and within solve what is Ceres' own.
//
//   graticule_bench                       every problem
//   graticule_bench --benchmark_filter=solve/sphere
//
// Counters: `load_MB_per_s`; `build_of_solve`, the share of building.
//
// overhead/ puts what minimising takes, with Ceres and without, over a bare loop of as many
// evaluations, assemblies, factorisations and solves as Ceres takes steps (CPU time of this
// process, everything in one run).

#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "graticule/solver/normal_equations.hpp"
#include "graticule/solver/numeric_guard.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

constexpr const char* kProblems[] = {
    "intel.g2o",          "MIT.g2o",          "CSAIL.g2o",      "manhattan.g2o",
    "M3500.g2o",          "city10000.g2o.gz", "kitti_00.g2o",   "victoria_park.g2o",
    "parking-garage.g2o", "sphere2500.g2o",   "torus3D.g2o.gz", "synth-problem-49-7776-pre.txt.gz"};

std::string PathOf(const std::string& problem) {
  return std::string(GRATICULE_DATA_DIR) + "/posegraph/" + problem;
}

void Load(benchmark::State& state, const std::string& path) {
  const std::string text = ReadFile(path);
  const Registry types = Builtins();
  for (auto _ : state)
    benchmark::DoNotOptimize(ParseProblem(text, path, types).graph.FactorCount());
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) *
                          static_cast<std::int64_t>(state.iterations()));
}

void SolveFile(benchmark::State& state, const std::string& path) {
  Recording recording = ReadProblem(path, Builtins());
  Initialise(&recording.graph, InitialGuess::kAutomatic, recording.has_initial_guess);
  Timing sum;
  std::size_t steps = 0;
  for (auto _ : state) {
    const Report report = Solve(recording.graph).report;
    sum.build.wall += report.timing.build.wall;
    sum.solve.wall += report.timing.solve.wall;
    sum.preprocess += report.timing.preprocess;
    sum.evaluate += report.timing.evaluate;
    sum.linear_solve += report.timing.linear_solve;
    steps = report.Steps();
  }
  const double runs = static_cast<double>(state.iterations());
  state.counters["steps"] = static_cast<double>(steps);
  state.counters["build_ms"] = 1e3 * sum.build.wall / runs;
  state.counters["evaluate_ms"] = 1e3 * sum.evaluate / runs;
  state.counters["linear_ms"] = 1e3 * sum.linear_solve / runs;
  state.counters["preprocess_ms"] = 1e3 * sum.preprocess / runs;
  state.counters["build_of_solve"] = sum.build.wall / sum.solve.wall;
}

// Seconds of CPU that so many Gauss-Newton steps' arithmetic takes, and nothing else does.
double BareLoop(const Graph& graph, std::size_t steps) {
  const NumericGuard guard;
  const Evaluation evaluation(graph);
  std::vector<char> is_held(graph.VariableCount(), 0);
  is_held[graph.KeyOrder().front()] = 1;
  NormalEquations equations(evaluation, std::nullopt, is_held, 1);
  const std::vector<double> data = graph.InitialValues().Data();
  const Stopwatch clock;
  double objective = 0;
  for (std::size_t i = 0; i < steps; ++i) {
    equations.Linearise(data.data(), &objective);
    std::vector<double> step = equations.Gradient();
    equations.System().Solve(&step, 1);
    benchmark::DoNotOptimize(step.data());
  }
  return clock.Elapsed().cpu;
}

void Overhead(benchmark::State& state, const std::string& path) {
  Recording recording = ReadProblem(path, Builtins());
  Initialise(&recording.graph, InitialGuess::kAutomatic, recording.has_initial_guess);
  SolveOptions ceres, direct;
  ceres.engine = Engine::kCeres;
  direct.engine = Engine::kDirect;
  // A bare loop takes as many steps as the engine that it is compared with, and the one more that
  // finds the minimum reached.
  struct Sum {
    double engine_s = 0, bare_s = 0;
    std::size_t steps = 0;
  } with, without;
  const auto run = [&](const SolveOptions& options, Sum* sum) {
    const Report report = Solve(recording.graph, options).report;
    sum->steps = report.Steps();
    sum->engine_s += report.timing.solve.cpu;
    sum->bare_s += BareLoop(recording.graph, sum->steps + 1);
  };
  for (auto _ : state) {
    run(ceres, &with);
    run(direct, &without);
  }
  state.counters["ceres_steps"] = static_cast<double>(with.steps);
  state.counters["ceres_over_bare"] = with.engine_s / with.bare_s;
  state.counters["direct_steps"] = static_cast<double>(without.steps);
  state.counters["direct_over_bare"] = without.engine_s / without.bare_s;
}

void LoadSimulated(benchmark::State& state) {
  CityOptions options;
  options.poses_per_robot = static_cast<int>(state.range(0)) / options.robots;
  Recording recording(Builtins());
  recording.graph = SimulateCity(Builtins(), options).graph;
  const std::string path = std::filesystem::temp_directory_path() / "graticule_bench.g2o";
  WriteProblem(path, recording);
  Load(state, path);
  std::filesystem::remove(path);
}

void RegisterAll() {
  for (const char* problem : kProblems) {
    const std::string path = PathOf(problem);
    if (!std::filesystem::exists(path)) continue;
    const std::string name = std::filesystem::path(problem).stem().string();
    benchmark::RegisterBenchmark(("load/" + name).c_str(), Load, path)
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("solve/" + name).c_str(), SolveFile, path)
        ->Unit(benchmark::kMillisecond);
    if (std::string(problem).find("synth") == std::string::npos &&
        std::string(problem).find("victoria") == std::string::npos)
      benchmark::RegisterBenchmark(("overhead/" + name).c_str(), Overhead, path)
          ->Unit(benchmark::kMillisecond);
  }
  benchmark::RegisterBenchmark("load/city", LoadSimulated)
      ->Arg(100000)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  graticule::RegisterAll();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
