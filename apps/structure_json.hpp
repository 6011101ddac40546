#pragma once

#include <nlohmann/json_fwd.hpp>

#include "graticule/solver/diagnose.hpp"

namespace graticule::apps {

/// `pieces`, `isolated` and `starved`, as docs/command.md says.
nlohmann::ordered_json StructureJson(const Graph& graph, const Structure& structure);

}  // namespace graticule::apps
