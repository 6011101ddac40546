#pragma once

#include <string>
#include <utility>
#include <vector>

#include "graticule/io/accuracy.hpp"

namespace graticule {

/// Part of a page: the errors of runs against the truth, a row for all poses and one for each
/// family.  The first of a pair names the run; where it is empty, runs have no names.
std::string AccuracyHtml(const std::vector<std::pair<std::string, const Accuracy*>>& runs);

}  // namespace graticule
