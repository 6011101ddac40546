#include <algorithm>
#include <cmath>

#include "graticule/io/accuracy_html.hpp"
#include "graticule/io/chart.hpp"
#include "graticule/io/comparison.hpp"
#include "graticule/io/comparison_columns.hpp"
#include "graticule/io/html.hpp"
#include "graticule/io/phase_chart.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

/// Objectives are equal to about the solver's tolerance; below this share of the best there is
/// nothing to see.
constexpr double kFloor = 1e-9;

// The columns of the first rank, or the configuration and those of the second; empty if there are
// none.
std::string Table(const ComparisonBlock& block, bool main) {
  std::vector<html::Column> columns;
  std::vector<std::vector<html::Cell>> rows(block.runs.size());
  for (const ComparisonColumn& column : block.columns) {
    const bool first = &column == &block.columns.front();
    if (!first && column.main != main) continue;
    columns.push_back({column.name, column.number, column.hint});
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const ComparisonCell& cell = column.cells[i];
      rows[i].push_back({cell.text, cell.best ? "best" : cell.bad ? "bad" : first ? "name" : ""});
    }
  }
  return columns.size() > 1 ? html::Table(columns, rows) : std::string();
}

// With a loss the objective is another function than 0.5 r'Wr.
bool IsRobust(const ComparisonRun& run) {
  const Report& report = run.report;
  return std::fabs(report.final_objective - report.final_cost) >
         1e-9 * std::fabs(report.final_cost);
}

double LowestObjective(const ComparisonRun& run) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Iteration& step : run.report.iterations)
    if (step.accepted && std::isfinite(step.objective)) lowest = std::min(lowest, step.objective);
  return lowest;
}

// Objective above the lowest one that anybody reached, against the time since the solve began; of a
// run with a loss, above its own lowest.
std::string Convergence(const ComparisonBlock& block) {
  double best = std::numeric_limits<double>::infinity();
  bool any_robust = false;
  for (const ComparisonRun* run : block.runs) {
    if (!run->error.empty()) continue;
    if (std::isfinite(run->best_known)) best = std::min(best, run->best_known);
    if (IsRobust(*run)) {
      any_robust = true;
    } else {
      best = std::min(best, LowestObjective(*run));
    }
  }
  for (const ComparisonRun* run : block.runs)  // where every run has a loss
    if (!std::isfinite(best) && run->error.empty()) best = LowestObjective(*run);
  if (!std::isfinite(best)) return {};
  const double floor = std::max(kFloor * std::fabs(best), 1e-15);

  CurveChart chart;
  chart.title = "Convergence";
  chart.x_label = "time since the solve began [s]";
  chart.y_label = "objective above the best, " + ReadableNumber(best, 6);
  chart.x_scale = chart.y_scale = AxisScale::kLogarithmic;
  chart.width = 1140;
  chart.height = 400;
  for (const ComparisonRun* run : block.runs) {
    if (!run->error.empty()) continue;
    const bool robust = IsRobust(*run);
    const double base = robust ? LowestObjective(*run) : best;
    Curve curve{run->configuration + (robust ? " *" : ""), {}};
    for (const Iteration& step : run->report.iterations)
      if (step.accepted)
        curve.points.push_back({step.seconds, std::max(step.objective - base, floor)});
    chart.curves.push_back(std::move(curve));
  }
  return html::Figure(DrawCurves(chart)) +
         html::Paragraph("Differences below " + ReadableNumber(floor, 2) + " are drawn as that." +
                             (any_robust ? "  * With a loss the objective is another function: "
                                           "drawn above its own lowest value."
                                         : ""),
                         "soft");
}

std::string Phases(const ComparisonBlock& block) {
  std::vector<std::pair<std::string, Timing>> runs;
  for (const ComparisonRun* run : block.runs)
    if (run->error.empty()) runs.emplace_back(run->configuration, run->median);
  return runs.empty() ? std::string()
                      : html::Figure(DrawPhases("Wall time by phase, median", runs, 1140));
}

std::string Errors(const ComparisonBlock& block) {
  std::string errors;
  for (const ComparisonRun* run : block.runs)
    if (!run->error.empty())
      errors += html::Paragraph(run->configuration + " failed: " + run->error);
  return errors;
}

std::string Remarks(const ComparisonBlock& block) {
  return block.remarks.empty() ? std::string() : html::List(block.remarks);
}

std::string AgainstTruth(const ComparisonBlock& block) {
  std::vector<std::pair<std::string, const Accuracy*>> runs;
  for (const ComparisonRun* run : block.runs)
    if (run->accuracy) runs.emplace_back(run->configuration, &*run->accuracy);
  return AccuracyHtml(runs);
}

std::string SizeOf(const ComparisonBlock& block) {
  for (const ComparisonRun* run : block.runs)
    if (run->error.empty())
      return html::Paragraph(ReadableCount(run->report.variables) + " variables, " +
                                 ReadableCount(run->report.factors) + " factors, " +
                                 ReadableCount(run->report.residuals) + " residuals",
                             "soft");
  return {};
}

}  // namespace

std::string ComparisonHtml(const Comparison& comparison) {
  const std::vector<ComparisonBlock> blocks = ComparisonBlocks(comparison);
  std::string body;
  std::size_t failed = 0, repeats = 1;
  for (const ComparisonRun& run : comparison.runs) {
    failed += run.error.empty() ? 0 : 1;
    repeats = std::max(repeats, run.repeats);
  }
  for (const ComparisonBlock& block : blocks) {
    const std::string more = Table(block, false);
    body += html::Section(block.file, SizeOf(block) + Remarks(block) + Table(block, true) +
                                          Errors(block) +
                                          (more.empty() ? "" : html::Details("More times", more)) +
                                          AgainstTruth(block) + Convergence(block) + Phases(block));
  }
  if (!comparison.provenance.empty()) {
    std::vector<std::vector<html::Cell>> rows;
    for (const auto& [name, value] : comparison.provenance)
      rows.push_back({{name}, {value, "key"}});
    body += html::Section("Provenance", html::Table({{"name", false}, {"value", false}}, rows));
  }
  std::string line = ReadableCount(comparison.runs.size()) + " runs on " +
                     ReadableCount(blocks.size()) + (blocks.size() == 1 ? " problem" : " problems");
  if (repeats > 1)
    line += ", up to " + ReadableCount(repeats) + " repeats each (times are medians)";
  if (failed) line += ", " + ReadableCount(failed) + " failed";
  const std::string header =
      "<h1>Comparison</h1>\n" + html::Paragraph(line, "soft") +
      html::Paragraph(
          "Best of each column in bold; times and memory among the runs that converged.", "soft");
  return html::Page("Graticule comparison", header, body);
}

}  // namespace graticule
