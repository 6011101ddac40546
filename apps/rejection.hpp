#pragma once

#include "graticule/io/report_context.hpp"
#include "graticule/problems/pose_graph/robustify.hpp"

namespace graticule::apps {

/// For reports.
RejectionSummary Summarise(const Graph& graph, const RejectionReport& rejection);

/// What was taken as suspect and what was rejected, for people.
void PrintRejection(const RejectionSummary& rejection);

}  // namespace graticule::apps
