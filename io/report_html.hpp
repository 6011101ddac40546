#pragma once

#include <string>

#include "graticule/io/report_context.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

/// The report as one self-contained page, for people: verdict, key numbers, the graph before and
/// after, convergence, time by phase, cost by type and source, worst factors, warnings, options,
/// provenance.  No script, no network.  `graph_svg` is from DrawGraph; empty: no figure.
std::string ReportHtml(const Report& report, const ReportContext& context = {},
                       const std::string& graph_svg = {});

/// What a run's end means: "good" (converged), "fair" (stopped early) or "bad" (failed).
std::string VerdictClass(Termination termination);
/// "converged", "did not converge", "time limit reached", "cancelled", "failed".
std::string VerdictText(Termination termination);

}  // namespace graticule
