#include "graticule/io/comparison_columns.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "graticule/io/readable.hpp"
#include "graticule/io/report_html.hpp"

namespace graticule {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

enum class Contest {
  kNone,
  kAll,        // the lowest of all runs wins
  kConverged,  // the lowest of those that converged wins
};

struct Definition {
  const char* name;
  const char* hint;
  bool main;
  Contest contest;
  double tie;  // relative: values this close are equally good
  double (*value)(const ComparisonRun&);
  std::string (*text)(double);
};

// Timers and allocators repeat to a few per cent; costs to the solver's tolerance.
constexpr double kTimeTie = 0.02, kCostTie = 1e-7, kErrorTie = 1e-4;

std::string Cost(double value) { return ReadableNumber(value, 7); }
std::string Count(double value) { return ReadableNumber(value, 9); }
std::string Bytes(double value) {
  return ReadableBytes(value > 0 ? static_cast<std::uint64_t>(value) : 0);
}
std::string Metres(double value) { return ReadableNumber(value, 3) + " m"; }
// Nothing was measured where nothing has passed.
std::string Time(double value) { return ReadableSeconds(value > 0 ? value : kNone); }

using Run = ComparisonRun;

constexpr Definition kDefinitions[] = {
    {"final cost", "0.5 sum of chi2, without losses", true, Contest::kAll, kCostTie,
     [](const Run& run) { return run.report.final_cost; }, Cost},
    {"gap", "(final cost - best known) / best known", true, Contest::kNone, 0,
     [](const Run& run) { return run.gap; }, ReadableGap},
    {"steps", "of the solver, accepted and rejected", true, Contest::kNone, 0,
     [](const Run& run) { return static_cast<double>(run.report.Steps()); }, Count},
    {"total", "wall time, median of the repeats", true, Contest::kConverged, kTimeTie,
     [](const Run& run) { return run.median.total.wall; }, Time},
    {"CPU", "all threads, whole run", true, Contest::kConverged, kTimeTie,
     [](const Run& run) { return run.median.total.cpu; }, Time},
    {"fastest", "of the repeats", false, Contest::kNone, 0,
     [](const Run& run) { return run.repeats > 1 ? run.min_total_s : kNone; }, Time},
    {"slowest", "of the repeats", false, Contest::kNone, 0,
     [](const Run& run) { return run.repeats > 1 ? run.max_total_s : kNone; }, Time},
    {"load", "wall time", false, Contest::kNone, 0,
     [](const Run& run) { return run.median.load.wall; }, Time},
    {"initialise", "wall time", false, Contest::kNone, 0,
     [](const Run& run) { return run.median.initialise.wall; }, Time},
    {"build", "wall time", false, Contest::kNone, 0,
     [](const Run& run) { return run.median.build.wall; }, Time},
    {"solve", "wall time", true, Contest::kConverged, kTimeTie,
     [](const Run& run) { return run.median.solve.wall; }, Time},
    {"solve CPU", "all threads", false, Contest::kNone, 0,
     [](const Run& run) { return run.median.solve.cpu; }, Time},
    {"evaluate", "wall time inside solve: residuals and Jacobians", false, Contest::kNone, 0,
     [](const Run& run) { return run.median.evaluate; }, Time},
    {"linear", "wall time inside solve: linear solves", true, Contest::kNone, 0,
     [](const Run& run) { return run.median.linear_solve; }, Time},
    {"memory", "peak of the process", true, Contest::kConverged, kTimeTie,
     [](const Run& run) {
       return run.peak_memory_bytes ? static_cast<double>(run.peak_memory_bytes) : kNone;
     },
     Bytes},
    {"ATE", "absolute trajectory error, rmse after alignment", true, Contest::kAll, kErrorTie,
     [](const Run& run) {
       return run.accuracy ? run.accuracy->together.ate.translation_m.rmse : kNone;
     },
     Metres},
    {"RPE", "relative pose error a step, rmse", true, Contest::kAll, kErrorTie,
     [](const Run& run) {
       return run.accuracy ? run.accuracy->together.rpe_step.translation_m.rmse : kNone;
     },
     Metres},
};

bool Competes(const Run& run, Contest contest) {
  if (contest == Contest::kNone || !run.error.empty()) return false;
  return contest == Contest::kAll || run.report.termination == Termination::kConverged;
}

// Columns that nobody fills are empty in `cells`.
ComparisonColumn Fill(const Definition& definition, const std::vector<const Run*>& runs) {
  ComparisonColumn column{definition.name, definition.hint, true, definition.main, {}};
  bool filled = false;
  double best = std::numeric_limits<double>::infinity();
  int competitors = 0;
  for (const Run* run : runs) {
    const double value = run->error.empty() ? definition.value(*run) : kNone;
    const std::string text = std::isfinite(value) ? definition.text(value) : "–";
    filled = filled || text != "–";
    column.cells.push_back({text});
    if (text == "–" || !Competes(*run, definition.contest)) continue;
    best = std::min(best, value);
    ++competitors;
  }
  if (!filled) column.cells.clear();
  if (competitors < 2 || column.cells.empty()) return column;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!Competes(*runs[i], definition.contest)) continue;
    const double value = definition.value(*runs[i]);
    column.cells[i].best = value <= best + definition.tie * std::fabs(best);
  }
  return column;
}

ComparisonColumn Text(const char* name, const std::vector<const Run*>& runs,
                      const std::function<ComparisonCell(const Run&)>& cell) {
  ComparisonColumn column{name, {}, false, true, {}};
  for (const Run* run : runs) column.cells.push_back(cell(*run));
  return column;
}

}  // namespace

std::vector<ComparisonBlock> ComparisonBlocks(const Comparison& comparison) {
  std::vector<ComparisonBlock> blocks;
  for (const ComparisonRun& run : comparison.runs) {
    auto block = std::find_if(blocks.begin(), blocks.end(), [&](const ComparisonBlock& candidate) {
      return candidate.file == run.file;
    });
    if (block == blocks.end()) block = blocks.insert(blocks.end(), {run.file, {}, {}, {}});
    block->runs.push_back(&run);
  }
  for (ComparisonBlock& block : blocks) {
    const auto repaired = std::find_if(block.runs.begin(), block.runs.end(),
                                       [](const Run* run) { return run->repaired.has_value(); });
    if (repaired != block.runs.end()) block.remarks.push_back(ToString(*(*repaired)->repaired));
    block.columns.push_back(Text("configuration", block.runs,
                                 [](const Run& run) { return ComparisonCell{run.configuration}; }));
    for (const Definition& definition : kDefinitions) {
      ComparisonColumn column = Fill(definition, block.runs);
      if (!column.cells.empty()) block.columns.push_back(std::move(column));
    }
    block.columns.push_back(Text("end", block.runs, [](const Run& run) {
      if (!run.error.empty()) return ComparisonCell{"failed", false, true};
      const bool bad = VerdictClass(run.report.termination) != "good";
      return ComparisonCell{VerdictText(run.report.termination), false, bad};
    }));
  }
  return blocks;
}

}  // namespace graticule
