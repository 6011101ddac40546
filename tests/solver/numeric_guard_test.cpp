#include "graticule/solver/numeric_guard.hpp"

#include <dlfcn.h>
#include <glog/logging.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <thread>

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

// As guards of several threads do.
TEST(NumericGuard, RestoresTheProcessHoweverGuardsOverlap) {
  const auto blas_threads =
      reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  ASSERT_NE(blas_threads, nullptr);
  const int level = FLAGS_minloglevel, threads = blas_threads();
  std::optional<NumericGuard> first(std::in_place), second;
  std::thread([&] { second.emplace(); }).join();
  first.reset();
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_FATAL) << "the second still lives";
  EXPECT_EQ(blas_threads(), 1);
  std::thread([&] { second.reset(); }).join();
  EXPECT_EQ(FLAGS_minloglevel, level);
  EXPECT_EQ(blas_threads(), threads);
}

}  // namespace
}  // namespace graticule
