#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "commands.hpp"
#include "compare_runs.hpp"
#include "compare_state.hpp"
#include "graticule/io/config.hpp"
#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/provenance.hpp"
#include "problem.hpp"
#include "spread.hpp"

namespace graticule::apps {
namespace {

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

int Compare(const CompareCommand& command, const Console& console, Spread* spread) {
  CompareRuns runs(command, console);
  const Spread::Handler handler = [&](const std::string& request) {
    return runs.Handle(std::stoul(request));
  };
  const Interruptible interruptible;
  if (!spread->IsRoot()) {
    spread->Serve(handler);
    return kDone;
  }
  ExpectEnding(command.report, "--report", {".html", ".json"});
  ExpectWritable(command.report);
  ExpectWritable(command.state);
  const std::map<std::string, double> best_known = ReadBestKnown(command.best_known);

  std::vector<Exit> refused;
  std::map<std::size_t, std::optional<RepairedInformation>> repaired;  // by file, of those to solve
  for (std::size_t i = 0; i < command.files.size() && !Interruptible::WasAsked(); ++i) {
    try {
      repaired[i] = runs.Check(command.files[i]);
    } catch (const graticule::Error& error) {
      console.Error(error.what());
      refused.push_back(ExitOf(error.Kind()));
    }
  }
  std::map<std::size_t, ComparisonRun> found;  // by number: in the order of the command line
  const auto take = [&](std::size_t number, ComparisonRun run) {
    run.repaired = repaired.at(runs.FileOf(number));
    console.Progress("");
    if (!run.error.empty())
      console.Error(fmt::format("{} with {}: {}", run.file, run.configuration, run.error));
    found.emplace(number, std::move(run));
  };
  const std::string path = Interruptible::WasAsked() ? "" : command.state;
  CompareState state(path, path.empty() ? "" : runs.Fingerprint(), runs.Count());
  for (const auto& [number, run] : state.Kept()) take(number, run);
  std::vector<std::size_t> numbers;
  std::vector<std::string> requests;
  for (std::size_t number = 0; number < runs.Count(); ++number) {
    if (repaired.count(runs.FileOf(number)) == 0 || found.count(number) > 0) continue;
    numbers.push_back(number);
    requests.push_back(std::to_string(number));
  }
  spread->Run(requests, handler, [&](std::size_t i, const std::string& text) {
    CompareResult result = ResultOf(text);
    if (result.is_whole) state.Keep(numbers[i], result.run);
    take(numbers[i], std::move(result.run));
  });

  Comparison comparison;
  comparison.provenance = Provenance();
  for (auto& [number, run] : found) comparison.runs.push_back(std::move(run));
  AddGaps(best_known, &comparison.runs);
  // First the table: a full disk for the report must not cost the runs.
  fmt::print("{}", command.json ? ComparisonJson(comparison)
                                : ComparisonTable(comparison, console.Colour()));
  if (!command.report.empty())
    WriteFile(command.report, Ending(command.report) == ".html" ? ComparisonHtml(comparison)
                                                                : ComparisonJson(comparison));
  if (!command.report.empty() && !command.json) fmt::print("wrote {}\n", command.report);
  if (Interruptible::WasAsked() && !command.state.empty())
    console.Note("stopped; the same command goes on from here");
  return ExitOfRuns(comparison.runs, refused);
}

}  // namespace

int Run(const CompareCommand& command, const Console& console) {
  // One run at a time in a process: their times are what is compared.
  return WithSpread(1, [&](Spread* spread) { return Compare(command, console, spread); });
}

}  // namespace graticule::apps
