#pragma once

#include "graticule/io/report_context.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule::apps {

/// What `solve --certify` does: certifies the solution; where that is refused, looks for a cheaper
/// one, which then takes its place, with its report.
CertificateSummary CertifySolution(const Graph& graph, const SolveOptions& options,
                                   const Observer& watch, Solution* solution);

void PrintCertificate(const CertificateSummary& certificate);

}  // namespace graticule::apps
