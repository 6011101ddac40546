#include "graticule/solver/numeric_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>

#include "graticule/solver/provenance.hpp"

extern "C" void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned flags);

namespace graticule {
namespace {

// How often the body of an OpenMP region that asks for four threads runs.
int RunsOfARegion() {
  std::atomic<int> runs{0};
  GOMP_parallel([](void* data) { ++*static_cast<std::atomic<int>*>(data); }, &runs, 4, 0);
  return runs;
}

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
  EXPECT_EQ(names, (std::vector<std::string>{"graticule", "ceres", "eigen", "suitesparse",
                                             "cholmod", "blas"}));
}

TEST(NumericGuard, RunsOpenMpRegionsOnceWhileItLives) {
  {
    const NumericGuard guard;
    EXPECT_EQ(RunsOfARegion(), 1);
    {
      const NumericGuard inner;
      EXPECT_EQ(RunsOfARegion(), 1);
    }
    EXPECT_EQ(RunsOfARegion(), 1) << "the outer guard still lives";
  }
  EXPECT_EQ(RunsOfARegion(), 4) << "afterwards, and for anybody else, OpenMP is as it was";
}

}  // namespace
}  // namespace graticule
