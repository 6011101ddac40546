#pragma once

#include <optional>
#include <string>

#include "graticule/io/report_context.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

/// The report as one JSON object, for programs.  Members stand in a fixed order; doubles have all
/// their digits; nan and infinity are null; times are seconds; keys are text ("pose:12").  Ends
/// with a newline.
std::string ReportJson(const Report& report, const ReportContext& context = {});

/// What reports have under `repaired_information`: an object, or null where nothing was repaired.
std::string RepairedJson(const std::optional<RepairedInformation>& repaired);
/// What reports have under `accuracy`: an object, or null without a truth.
std::string AccuracyJson(const std::optional<Accuracy>& accuracy);

}  // namespace graticule
