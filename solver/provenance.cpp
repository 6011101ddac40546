#include "graticule/solver/provenance.hpp"

#include <cholmod.h>

#include <Eigen/Core>

#include "graticule/solver/ceres_bridge.hpp"
#include "graticule/solver/numeric_guard.hpp"
#include "graticule/version.hpp"

namespace graticule {

std::string Version() { return GRATICULE_VERSION; }

std::vector<std::pair<std::string, std::string>> Provenance() {
  const auto dots = [](int a, int b, int c) {
    return std::to_string(a) + "." + std::to_string(b) + "." + std::to_string(c);
  };
  return {{"graticule", Version()},
          {"ceres", CeresVersion()},
          {"eigen", dots(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"suitesparse",
           dots(SUITESPARSE_MAIN_VERSION, SUITESPARSE_SUB_VERSION, SUITESPARSE_SUBSUB_VERSION)},
          {"cholmod", dots(CHOLMOD_MAIN_VERSION, CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION)},
          {"blas", LoadedBlas()}};
}

}  // namespace graticule
