// Time by phase on recorded problems: load, build, solve, and within solve what is Ceres' own.
//
//   graticule_bench                       every problem
//   graticule_bench --benchmark_filter=solve/sphere
//
// Counters: `load_MB_per_s`; `build_of_solve`, the share of building; `ceres_share`, what of the
// solve is neither our evaluation of factors nor the reports around it.

#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "graticule/solver/solve.hpp"

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
  state.counters["ceres_share"] =
      (sum.preprocess + sum.linear_solve) / (sum.build.wall + sum.solve.wall);
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
