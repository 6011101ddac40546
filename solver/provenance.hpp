#pragma once

#include <string>
#include <utility>
#include <vector>

namespace graticule {

/// "0.1.0"
std::string Version();

/// Versions of Graticule, Ceres, Eigen, SuiteSparse, its CHOLMOD, and the BLAS that is loaded: what
/// a result depends on.
std::vector<std::pair<std::string, std::string>> Provenance();

}  // namespace graticule
