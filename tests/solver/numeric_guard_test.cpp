#include "graticule/solver/numeric_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "graticule/solver/provenance.hpp"

namespace graticule {
namespace {

// Debian's Ceres also brings ATLAS; whichever names dgemm_ first on the link line is used, and
// OpenBLAS is several times faster.  The alternatives system may stand between: its link is
// followed.
TEST(LoadedBlas, IsOpenBlas) {
  std::string path = LoadedBlas();
  if (char* real = realpath(path.c_str(), nullptr)) {
    path = real;
    free(real);
  }
  EXPECT_NE(path.find("openblas"), std::string::npos) << path;
}

TEST(Provenance, SaysWhatAResultDependsOn) {
  std::vector<std::string> names;
  for (const auto& [name, value] : Provenance()) {
    names.push_back(name);
    EXPECT_FALSE(value.empty()) << name;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"graticule", "ceres", "eigen", "cholmod", "blas"}));
}

}  // namespace
}  // namespace graticule
