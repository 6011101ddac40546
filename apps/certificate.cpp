#include "certificate.hpp"

#include <fmt/core.h>

#include <utility>

#include "configured_solve.hpp"
#include "console.hpp"
#include "graticule/problems/pose_graph/certify_escape.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule::apps {

CertificateSummary CertifySolution(const Graph& graph, const SolveOptions& options,
                                   const Observer& watch, Solution* solution) {
  const Stopwatch clock;
  const Graph asked = AsSolved(graph, options);
  CertifyOptions certifying;
  certifying.go_on = [] { return !Interruptible::WasAsked(); };
  Certificate certificate = Certify(asked, solution->values, certifying);
  CertificateSummary summary;
  summary.seconds = clock.Elapsed().wall;
  if (solution->report.termination != Termination::kCancelled && !Interruptible::WasAsked()) {
    EscapeOptions escaping;
    escaping.solve = options;
    escaping.certify = certifying;
    Escape escape =
        EscapeMinimum(asked, std::move(*solution), std::move(certificate), escaping, watch);
    *solution = std::move(escape.solution);
    certificate = std::move(escape.certificate);
    summary.improved = escape.improved;
    for (const EscapeAttempt& attempt : escape.attempts)
      summary.attempts.push_back(
          {attempt.from, ToString(attempt.verdict), attempt.cost, attempt.seconds});
  }
  summary.verdict = ToString(certificate.verdict);
  summary.text = certificate.summary;
  summary.is_applicable = certificate.verdict != Verdict::kNotApplicable;
  summary.cost = certificate.cost;
  summary.lower_bound = certificate.lower_bound;
  summary.gap = certificate.Gap();
  summary.relative_gap = certificate.RelativeGap();
  summary.eigenvalue = certificate.eigenvalue;
  summary.reasons = certificate.reasons;
  summary.exact_factors = certificate.exact_factors;
  summary.factors = certificate.factors;
  return summary;
}

void PrintCertificate(const CertificateSummary& certificate) {
  fmt::print("  optimality {}; {}\n", certificate.text, Seconds(certificate.seconds));
  for (const CertificateSummary::Attempt& attempt : certificate.attempts)
    fmt::print("             solved again from a {}: cost {:.9g}, {}; {}\n", attempt.from,
               attempt.cost, attempt.verdict, Seconds(attempt.seconds));
  if (!certificate.attempts.empty())
    fmt::print("             {}\n", certificate.improved
                                        ? "the solution above and in every output is the cheapest"
                                        : "nothing cheaper was found");
}

}  // namespace graticule::apps
