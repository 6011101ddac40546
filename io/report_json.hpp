#pragma once

#include <string>

#include "graticule/io/report_context.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

/// The report as one JSON object, for programs.  Members stand in a fixed order; doubles have all
/// their digits; nan and infinity are null; times are seconds; keys are text ("pose:12").  Ends
/// with a newline.
std::string ReportJson(const Report& report, const ReportContext& context = {});

}  // namespace graticule
