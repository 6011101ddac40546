#include "graticule/io/report_html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graticule/io/accuracy_html.hpp"
#include "graticule/io/chart.hpp"
#include "graticule/io/html.hpp"
#include "graticule/io/phase_chart.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

using html::Cell;

// The losses took something away, so that cost and objective differ.
bool HasLosses(const Report& report) {
  return std::fabs(report.final_objective - report.final_cost) >
         1e-9 * std::fabs(report.final_cost);
}

std::string MeaningOfReducedChi2(double reduced) {
  if (!std::isfinite(reduced)) return "no degrees of freedom";
  if (reduced < 0.5) return "residuals smaller than the noise says";
  if (reduced <= 2) return "residuals as large as the noise says";
  return "residuals larger than the noise says";
}

std::string Header(const Report& report, const ReportContext& context) {
  const std::string name = context.file.empty() ? "Solve report" : context.file;
  std::string header = "<h1>" + EscapeXml(name) + "</h1>\n";
  std::string line;
  const auto add = [&](const std::string& what, const std::string& value) {
    if (value.empty()) return;
    line += (line.empty() ? "" : " · ") + what + value;
  };
  add("format ", context.format);
  add("configuration ", context.configuration);
  add("initialised by ", context.initialisation);
  add("", report.linear_solver);
  if (!line.empty()) header += html::Paragraph(line, "soft");
  header += "<p><span class=\"verdict " + VerdictClass(report.termination) + "\">" +
            EscapeXml(VerdictText(report.termination)) + "</span> " + EscapeXml(report.message) +
            "</p>\n";
  if (context.second_look) header += html::Paragraph("Second look: " + context.second_look->text);
  return header;
}

std::string KeyNumbers(const Report& report, const ReportContext& context) {
  std::vector<html::Card> cards;
  cards.push_back({"Final cost, 0.5 Σ χ²", ReadableNumber(report.final_cost, 6),
                   "from " + ReadableNumber(report.initial_cost, 6)});
  if (HasLosses(report))
    cards.push_back({"Final objective, with losses", ReadableNumber(report.final_objective, 6),
                     "from " + ReadableNumber(report.initial_objective, 6)});
  cards.push_back({"χ² per degree of freedom", ReadableNumber(report.ReducedChi2(), 4),
                   MeaningOfReducedChi2(report.ReducedChi2())});
  const auto rejected = std::count_if(report.iterations.begin(), report.iterations.end(),
                                      [](const Iteration& step) { return !step.accepted; });
  cards.push_back({"Iterations", ReadableCount(report.Steps()),
                   rejected ? fmt::format("{} rejected", rejected) : "all accepted"});
  const Timing& timing = report.timing;
  cards.push_back({"Time, solve", ReadableSeconds(timing.solve.wall),
                   timing.total.wall > 0 ? ReadableSeconds(timing.total.wall) + " in all" : ""});
  cards.push_back({"Variables", ReadableCount(report.variables),
                   ReadableCount(report.fixed_variables) + " fixed, " +
                       ReadableCount(report.parameters) + " parameters"});
  cards.push_back(
      {"Factors", ReadableCount(report.factors), ReadableCount(report.residuals) + " residuals"});
  cards.push_back({"Degrees of freedom", fmt::format("{}", report.degrees_of_freedom),
                   "χ² " + ReadableNumber(report.Chi2(), 6)});
  cards.push_back({"Threads", fmt::format("{}", report.threads),
                   timing.solve.wall > 0
                       ? ReadableNumber(timing.solve.cpu / timing.solve.wall, 3) + " cores busy"
                       : ""});
  if (context.peak_memory_bytes)
    cards.push_back({"Peak memory", ReadableBytes(context.peak_memory_bytes), "whole process"});
  return html::Cards(cards);
}

std::string Notes(const Report& report) {
  std::string notes;
  if (!report.warnings.empty()) {
    notes += "<ul>\n";
    for (const std::string& warning : report.warnings)
      notes += "<li class=\"warning\">" + EscapeXml(warning) + "</li>\n";
    notes += "</ul>\n";
  }
  if (!report.anchors.empty()) {
    std::string anchors = "Held fixed to remove the gauge: ";
    for (std::size_t i = 0; i < report.anchors.size(); ++i)
      anchors += (i ? ", " : "") + report.anchors[i];
    notes += html::Paragraph(anchors);
  }
  return notes.empty() ? notes : html::Section("Warnings and anchors", notes);
}

std::string VerdictClass(const CertificateSummary& certificate) {
  if (certificate.verdict == "optimal") return "good";
  return certificate.verdict == "refused" ? "bad" : "fair";
}

std::string Optimality(const ReportContext& context) {
  if (!context.certificate) return {};
  const CertificateSummary& certificate = *context.certificate;
  std::string body =
      "<p><span class=\"verdict " + VerdictClass(certificate) + "\">" +
      EscapeXml(certificate.verdict == "not_applicable" ? "not applicable" : certificate.verdict) +
      "</span> " + EscapeXml(certificate.text) + "</p>\n";
  if (certificate.is_applicable)
    body += html::Cards({{"Lower bound of every cost", ReadableNumber(certificate.lower_bound, 9),
                          "cost " + ReadableNumber(certificate.cost, 9)},
                         {"Relative gap", ReadableNumber(certificate.relative_gap, 3),
                          fmt::format("{} of {} factors bounded without loss",
                                      ReadableCount(certificate.exact_factors),
                                      ReadableCount(certificate.factors))},
                         {"Time, certificate", ReadableSeconds(certificate.seconds), ""}});
  if (!certificate.attempts.empty()) {
    std::vector<std::vector<Cell>> rows;
    for (const CertificateSummary::Attempt& attempt : certificate.attempts)
      rows.push_back({{attempt.from},
                      {ReadableNumber(attempt.cost, 9)},
                      {attempt.verdict, attempt.verdict == "optimal" ? "good" : "bad"},
                      {ReadableSeconds(attempt.seconds)}});
    body += html::Paragraph(certificate.improved
                                ? "A cheaper solution was found; this page is about it."
                                : "Nothing cheaper was found.") +
            html::Table({{"solved again from", false, {}},
                         {"cost", true, {}},
                         {"certificate", false, {}},
                         {"time", true, {}}},
                        rows);
  }
  return html::Section("Global optimality", body);
}

std::string Convergence(const Report& report) {
  if (report.iterations.empty()) return {};
  CurveChart chart;
  chart.x_label = "iteration";
  chart.y_label = "objective";
  chart.whole_x = true;
  chart.width = 560;
  chart.height = 300;
  Curve curve;
  for (const Iteration& step : report.iterations)
    // A rejected step leaves the estimate where it was.
    if (step.accepted) curve.points.push_back({static_cast<double>(step.number), step.objective});
  chart.curves.push_back(std::move(curve));
  CurveChart gradient = chart;
  gradient.y_label = "largest gradient entry";
  gradient.y_scale = AxisScale::kLogarithmic;
  gradient.curves[0].points.clear();
  for (const Iteration& step : report.iterations)
    if (step.accepted)
      gradient.curves[0].points.push_back(
          {static_cast<double>(step.number), step.gradient_max_norm});

  std::vector<std::vector<Cell>> rows;
  for (const Iteration& step : report.iterations)
    rows.push_back({{fmt::format("{}", step.number)},
                    {step.accepted ? "accepted" : "rejected", step.accepted ? "" : "bad"},
                    {ReadableNumber(step.objective, 8)},
                    {ReadableNumber(step.objective_change, 4)},
                    {ReadableNumber(step.gradient_max_norm, 4)},
                    {ReadableNumber(step.step_norm, 4)},
                    {ReadableNumber(step.trust_region_radius, 3)},
                    {fmt::format("{}", step.linear_iterations)},
                    {ReadableSeconds(step.seconds)}});
  return html::Section(
      "Convergence",
      "<div class=\"pair\">" + html::Figure(DrawCurves(chart)) +
          html::Figure(DrawCurves(gradient)) + "</div>\n" +
          html::Details("Every iteration", html::Table({{"step", true, {}},
                                                        {"", false, {}},
                                                        {"objective", true, {}},
                                                        {"change", true, {}},
                                                        {"gradient", true, {}},
                                                        {"step length", true, {}},
                                                        {"trust region", true, {}},
                                                        {"linear iterations", true, {}},
                                                        {"since start", true, {}}},
                                                       rows)));
}

std::string Times(const Report& report) {
  const Timing& timing = report.timing;
  std::vector<std::vector<Cell>> rows;
  const double total = timing.total.wall;
  const auto add = [&](const char* name, double wall, double cpu, bool has_cpu) {
    if (!(wall > 0) && !(cpu > 0)) return;
    rows.push_back({{name, {}, total > 0 ? wall / total : -1},
                    {ReadableSeconds(wall)},
                    {has_cpu ? ReadableSeconds(cpu) : ""},
                    {total > 0 ? fmt::format("{:.1f} %", 100 * wall / total) : ""}});
  };
  add("load", timing.load.wall, timing.load.cpu, true);
  add("initialise", timing.initialise.wall, timing.initialise.cpu, true);
  add("build", timing.build.wall, timing.build.cpu, true);
  add("solve", timing.solve.wall, timing.solve.cpu, true);
  add("– preprocess", timing.preprocess, 0, false);
  add("– evaluate residuals and Jacobians", timing.evaluate, 0, false);
  add("– linear solve", timing.linear_solve, 0, false);
  add("write", timing.write.wall, timing.write.cpu, true);
  add("total", timing.total.wall, timing.total.cpu, true);
  if (rows.empty()) return {};
  return html::Section("Time by phase",
                       html::Figure(DrawPhases("", {{"wall time", timing}}, 1140)) +
                           html::Table({{"phase", false, {}},
                                        {"wall", true, {}},
                                        {"CPU, all threads", true, {}},
                                        {"of total wall", true, {}}},
                                       rows));
}

std::string Shares(const Report& report) {
  if (report.shares.empty()) return {};
  std::vector<std::vector<Cell>> rows;
  for (const CostShare& share : report.shares) {
    const double residuals = static_cast<double>(share.residuals);
    const double part = report.final_cost > 0 ? share.final_cost / report.final_cost : 0;
    rows.push_back({{share.type, "key"},
                    {share.source.empty() ? "–" : share.source},
                    {ReadableCount(share.factors)},
                    {ReadableCount(share.residuals)},
                    {ReadableNumber(share.initial_cost, 6)},
                    {ReadableNumber(share.final_cost, 6)},
                    {share.residuals ? ReadableNumber(2 * share.final_cost / residuals, 3) : "–"},
                    {fmt::format("{:.1f} %", 100 * part), {}, std::isfinite(part) ? part : -1}});
  }
  return html::Section("Cost by factor type and source",
                       html::Table({{"type", false, {}},
                                    {"source", false, {}},
                                    {"factors", true, {}},
                                    {"residuals", true, {}},
                                    {"initial cost", true, {}},
                                    {"final cost", true, {}},
                                    {"χ² per residual", true, "1: as large as the noise says"},
                                    {"of final cost", true, {}}},
                                   rows));
}

std::string Worst(const Report& report) {
  if (report.worst.empty()) return {};
  std::vector<std::vector<Cell>> rows;
  for (const WorstFactor& factor : report.worst) {
    std::string keys;
    for (const Key& key : factor.keys) keys += (keys.empty() ? "" : "  ") + key.ToString();
    const double per_residual = factor.chi2 / std::max(1, factor.residuals);
    rows.push_back({{keys, "key"},
                    {factor.type, "key"},
                    {factor.source.empty() ? "–" : factor.source},
                    {ReadableCount(factor.id)},
                    {ReadableNumber(factor.chi2, 4)},
                    {ReadableNumber(per_residual, 4), per_residual > 9 ? "bad" : ""},
                    {ReadableNumber(factor.weight, 3)}});
  }
  return html::Section("Factors that disagree most",
                       html::Table({{"keys", false, {}},
                                    {"type", false, {}},
                                    {"source", false, {}},
                                    {"factor", true, "position in the graph, counted from 0"},
                                    {"χ²", true, {}},
                                    {"χ² per residual", true, "red above 9, three sigma"},
                                    {"loss weight", true, "what the loss left of it: 1 is all"}},
                                   rows));
}

std::string Rejection(const ReportContext& context) {
  if (!context.rejection) return {};
  constexpr std::size_t kMost = 1000;
  const RejectionSummary& rejection = *context.rejection;
  std::vector<std::vector<Cell>> rows;
  for (const RejectedFactor& factor : rejection.rejected) {
    if (rows.size() == kMost) break;
    std::string keys;
    for (const Key& key : factor.keys) keys += (keys.empty() ? "" : "  ") + key.ToString();
    rows.push_back({{keys, "key"},
                    {factor.type, "key"},
                    {factor.source.empty() ? "–" : factor.source},
                    {ReadableCount(factor.id)},
                    {ReadableNumber(factor.chi2, 4)},
                    {ReadableNumber(factor.limit, 4)}});
  }
  std::string body = html::Paragraph(fmt::format(
      "{} of {} suspect factors rejected by {}, beyond the {} quantile with the noise times {}; {} "
      "factors trusted.",
      rejection.rejected.size(), rejection.suspects, rejection.method, rejection.inlier_quantile,
      ReadableNumber(rejection.inlier_noise_scale, 3), rejection.trusted));
  if (!rows.empty())
    body += html::Details(
        rejection.rejected.size() > kMost ? fmt::format("The first {}", kMost) : "All of them",
        html::Table({{"keys", false, {}},
                     {"type", false, {}},
                     {"source", false, {}},
                     {"factor", true, "position in the graph, counted from 0"},
                     {"χ²", true, "at the solution without it"},
                     {"limit", true, "the χ² up to which it would have been kept"}},
                    rows));
  return html::Section("Rejected factors", body);
}

std::string Pairs(const std::vector<std::pair<std::string, std::string>>& pairs) {
  std::vector<std::vector<Cell>> rows;
  for (const auto& [name, value] : pairs) rows.push_back({{name}, {value, "key"}});
  return html::Table({{"name", false, {}}, {"value", false, {}}}, rows);
}

std::string Origin(const Report& report, const ReportContext& context) {
  std::string body;
  if (!context.outputs.empty()) body += html::Paragraph("Written to") + html::List(context.outputs);
  if (!context.extras.empty()) body += Pairs(context.extras);
  if (!report.options.empty()) body += html::Details("All options", Pairs(report.options));
  if (!report.provenance.empty()) body += Pairs(report.provenance);
  return body.empty() ? body : html::Section("Options and provenance", body);
}

}  // namespace

std::string VerdictClass(Termination termination) {
  if (termination == Termination::kConverged) return "good";
  return termination == Termination::kFailed ? "bad" : "fair";
}

std::string VerdictText(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kNoConvergence:
      return "did not converge";
    case Termination::kTimeLimit:
      return "time limit reached";
    case Termination::kCancelled:
      return "cancelled";
    case Termination::kFailed:
      return "failed";
  }
  return "failed";
}

std::string ReportHtml(const Report& report, const ReportContext& context,
                       const std::string& graph_svg) {
  const std::string title = context.file.empty() ? "Graticule report" : context.file;
  std::string body = KeyNumbers(report, context) + Optimality(context) + Notes(report);
  if (!graph_svg.empty()) body += html::Section("The graph", html::Figure(graph_svg));
  if (context.accuracy)
    body += html::Section("Poses against the truth", AccuracyHtml({{"", &*context.accuracy}}));
  body += Rejection(context) + Convergence(report) + Shares(report) + Worst(report) +
          Times(report) + Origin(report, context);
  return html::Page(title, Header(report, context), body);
}

}  // namespace graticule
