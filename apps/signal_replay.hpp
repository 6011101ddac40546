#pragma once

#include <vector>

#include "signal_input.hpp"

namespace graticule::apps {

/// The replay of one log by a method.
ReplayResult ReplayOf(const LoadedSignal& signal, const std::string& method,
                      const MethodOptions& options, const ReplayOptions& replay);

/// Several logs' results as one: means weighed by counts.
ReplayResult Together(const std::vector<ReplayResult>& results);

}  // namespace graticule::apps
