#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "commands.hpp"
#include "configured_solve.hpp"
#include "graticule/io/comparison.hpp"
#include "graticule/io/config.hpp"
#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/provenance.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "ground_truth.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

Timing MedianOf(const std::vector<Timing>& runs) {
  const auto of = [&](const auto& get) {
    std::vector<double> values;
    for (const Timing& run : runs) values.push_back(get(run));
    return Median(values);
  };
  Timing median;
  for (PhaseTime Timing::*phase : {&Timing::load, &Timing::initialise, &Timing::build,
                                   &Timing::solve, &Timing::write, &Timing::total})
    median.*phase = {of([&](const Timing& t) { return (t.*phase).wall; }),
                     of([&](const Timing& t) { return (t.*phase).cpu; })};
  for (double Timing::*part : {&Timing::preprocess, &Timing::evaluate, &Timing::linear_solve})
    median.*part = of([&](const Timing& t) { return t.*part; });
  return median;
}

// One whole run, from the file: load, initialise, build, solve; what comes after is not counted.
Report RunOnce(const std::string& file, const Reading& reading, const Registry& types,
               const Configuration& configuration, const Console& console, const std::string& what,
               const TruthOf& truth, std::optional<Accuracy>* accuracy) {
  const Stopwatch total;
  Stopwatch clock;
  Console silent;
  silent.quiet = true;
  Recording recording = Load(file, reading, types, silent);
  const PhaseTime load = clock.Lap();
  ConfiguredSolution solved = SolveAsConfigured(&recording.graph, recording.has_initial_guess,
                                                configuration, Watch(console, what));
  Report& report = solved.solution.report;
  if (recording.repaired) report.warnings.push_back(ToString(*recording.repaired));
  report.timing.load = load;
  report.timing.initialise = solved.initialise;
  report.timing.total = total.Elapsed();
  if (report.termination != Termination::kFailed)
    *accuracy = truth.Judge(recording.graph, solved.solution.values);
  return std::move(report);
}

ComparisonRun Repeat(const std::string& file, const CompareCommand& command, const Registry& types,
                     const Configuration& configuration, const TruthOf& truth,
                     const Console& console) {
  ComparisonRun run;
  run.file = file;
  run.configuration = configuration.name;
  run.repeats = static_cast<std::size_t>(command.repeats);
  std::vector<Timing> timings;
  try {
    ResetPeakMemory();
    for (int i = 0; i <= command.repeats && !Interruptible::WasAsked(); ++i) {
      const std::string what =
          fmt::format("{} {} {}/{}", file, configuration.name, i, command.repeats);
      Report report =
          RunOnce(file, command.reading, types, configuration, console, what, truth, &run.accuracy);
      // The first run counts only where it stays the only one: its caches were cold.
      if (i > 0) timings.push_back(report.timing);
      if (i <= 1) run.report = std::move(report);
    }
    run.peak_memory_bytes = PeakMemory();
  } catch (const graticule::Error& error) {
    run.error = error.what();
  }
  if (timings.empty()) timings.push_back(run.report.timing);
  run.median = MedianOf(timings);
  run.min_total_s = run.max_total_s = timings[0].total.wall;
  for (const Timing& timing : timings) {
    run.min_total_s = std::min(run.min_total_s, timing.total.wall);
    run.max_total_s = std::max(run.max_total_s, timing.total.wall);
  }
  return run;
}

// Best known costs by file name.
std::map<std::string, double> ReadBestKnown(const std::string& path) {
  std::map<std::string, double> best;
  if (path.empty()) return best;
  for (const ConfigEntry& entry : ParseConfig(ReadFile(path), path)) {
    double cost = 0;
    const char* end = entry.value.data() + entry.value.size();
    const auto [stop, problem] = std::from_chars(entry.value.data(), end, cost);
    if (problem != std::errc() || stop != end || !std::isfinite(cost))
      throw Error(path, entry.line, entry.column, "expected a cost, found '" + entry.value + "'");
    best[entry.name] = cost;
  }
  return best;
}

// Gaps to the best known costs; to the lowest of this comparison where none is known.  A run that
// rejected factors answers another question: it has no gap.
void AddGaps(const std::map<std::string, double>& best, std::vector<ComparisonRun>* runs) {
  std::map<std::string, double> lowest;
  std::map<std::string, std::size_t> factors;
  for (const ComparisonRun& run : *runs)
    factors[run.file] = std::max(factors[run.file], run.report.factors);
  const auto rejected = [&](const ComparisonRun& run) {
    return run.report.factors < factors[run.file];
  };
  for (const ComparisonRun& run : *runs) {
    if (!run.error.empty() || rejected(run) || !std::isfinite(run.report.final_cost)) continue;
    const auto entry = lowest.emplace(run.file, run.report.final_cost).first;
    entry->second = std::min(entry->second, run.report.final_cost);
  }
  for (ComparisonRun& run : *runs) {
    if (!run.error.empty()) continue;
    const auto known = best.find(std::filesystem::path(run.file).filename().string());
    const auto found = lowest.find(run.file);
    run.best_known = known != best.end()     ? known->second
                     : found != lowest.end() ? found->second
                                             : std::nan("");
    // Where the optimum is zero a ratio means nothing: then relative to the start, far below it.
    run.gap = (run.report.final_cost - run.best_known) /
              std::max({std::abs(run.best_known), 1e-12 * run.report.initial_cost, 1e-300});
    if (rejected(run)) run.gap = std::nan("");
  }
}

// A file that was refused counts most, then a run without a result.  Runs that did not converge are
// a result.
int ExitOfRuns(const std::vector<ComparisonRun>& runs, const std::vector<Exit>& refused) {
  for (const Exit exit : refused) return exit;
  for (const ComparisonRun& run : runs)
    if (!run.error.empty() || run.report.termination == Termination::kFailed) return kOtherFailure;
  return Interruptible::WasAsked() ? kNotConverged : kDone;
}

}  // namespace

int Run(const CompareCommand& command, const Console& console) {
  ExpectEnding(command.report, "--report", {".html", ".json"});
  ExpectWritable(command.report);
  std::vector<Configuration> configurations;
  for (const std::string& name : command.configs)
    configurations.push_back(Choose({name, command.settings}));
  const std::map<std::string, double> best_known = ReadBestKnown(command.best_known);
  const Registry types = LoadTypes(command.reading);

  Comparison comparison;
  comparison.provenance = Provenance();
  std::vector<Exit> refused;
  {
    const Interruptible interruptible;
    for (const std::string& file : command.files) {
      std::optional<RepairedInformation> repaired;
      std::optional<TruthOf> truth;
      try {
        // Once: a file that is refused is refused once.
        const Recording recording = Load(file, command.reading, types, console);
        repaired = recording.repaired;
        truth.emplace(command.comparing, command.reading, recording.graph, console);
      } catch (const graticule::Error& error) {
        console.Error(error.what());
        refused.push_back(ExitOf(error.Kind()));
        continue;
      }
      for (const Configuration& configuration : configurations) {
        if (Interruptible::WasAsked()) break;
        comparison.runs.push_back(Repeat(file, command, types, configuration, *truth, console));
        comparison.runs.back().repaired = repaired;
        console.Progress("");
        if (!comparison.runs.back().error.empty())
          console.Error(fmt::format("{} with {}: {}", file, configuration.name,
                                    comparison.runs.back().error));
      }
    }
    AddGaps(best_known, &comparison.runs);
    // First the table: a full disk for the report must not cost the runs.
    fmt::print("{}", command.json ? ComparisonJson(comparison)
                                  : ComparisonTable(comparison, console.Colour()));
    if (!command.report.empty())
      WriteFile(command.report, Ending(command.report) == ".html" ? ComparisonHtml(comparison)
                                                                  : ComparisonJson(comparison));
    if (!command.report.empty() && !command.json) fmt::print("wrote {}\n", command.report);
    return ExitOfRuns(comparison.runs, refused);
  }
}

}  // namespace graticule::apps
