#pragma once

#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// Which factors may be wrong, by their sources, where the rule below is not what is meant.
struct SuspectOptions {
  std::vector<std::string> trust;    ///< sources that are right whatever their kind
  std::vector<std::string> suspect;  ///< sources that may be wrong whatever their kind
};

/// The factors that may be wrong, in their order.  By rule: those between two poses that are not
/// odometry.  Odometry is what has the source "odometry"; without a source, what joins consecutive
/// numbers of one family.  All else (priors, sightings, observations) is trusted unless its source
/// is named.  Throws Error (kUsage): a source that no factor has, or that stands on both lists.
std::vector<FactorId> ChooseSuspects(const Graph& graph, const SuspectOptions& options = {});

/// Whether a factor between two poses is odometry, by the rule above.
bool IsOdometry(const Graph& graph, const FactorView& factor);

}  // namespace graticule
