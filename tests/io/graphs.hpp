#pragma once

// What the tests of several formats need: comparing graphs to the bit, temporary files, and the
// recorded data.

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "graticule/solver/error.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

inline bool SameBits(Span<const double> a, Span<const double> b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

/// Everything but the interning: keys, types, values, fixed, factors, noise, losses, sources.
inline void ExpectSameGraph(const Graph& a, const Graph& b) {
  ASSERT_EQ(a.VariableCount(), b.VariableCount());
  ASSERT_EQ(a.FactorCount(), b.FactorCount());
  for (VariableId id = 0; id < a.VariableCount(); ++id) {
    ASSERT_EQ(a.KeyOf(id).ToString(), b.KeyOf(id).ToString());
    ASSERT_EQ(a.TypeOf(id).name, b.TypeOf(id).name);
    ASSERT_EQ(a.IsFixed(id), b.IsFixed(id)) << a.KeyOf(id).ToString();
    ASSERT_TRUE(SameBits(a.ValueOf(id), b.ValueOf(id))) << a.KeyOf(id).ToString();
  }
  for (FactorId id = 0; id < a.FactorCount(); ++id) {
    const FactorView x = a.FactorAt(id), y = b.FactorAt(id);
    ASSERT_EQ(x.type->name, y.type->name) << id;
    ASSERT_EQ(x.variables.size(), y.variables.size()) << id;
    for (std::size_t i = 0; i < x.variables.size(); ++i)
      ASSERT_EQ(x.variables[i], y.variables[i]) << id;
    ASSERT_TRUE(SameBits(x.measurement, y.measurement)) << id;
    ASSERT_EQ(x.noise.kind, y.noise.kind) << id;
    ASSERT_TRUE(SameBits(x.noise.values, y.noise.values)) << id;
    ASSERT_TRUE(x.loss == y.loss) << id;
    ASSERT_EQ(x.source, y.source) << id;
  }
}

/// The text of the Error that `action` throws; "" and a failure if it throws none.
template <class Action>
std::string MessageOf(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

/// A directory that goes away with the test.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string pattern = ::testing::TempDir() + "graticule-io-XXXXXX";
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryDirectory() { std::filesystem::remove_all(path_); }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string DataFile(const std::string& name) {
  return std::string(GRATICULE_DATA_DIR) + "/posegraph/" + name;
}

inline bool IsContinuousIntegration() {
  const char* ci = std::getenv("CI");
  return ci && std::string(ci) == "true";
}

/// Skips the test where the recorded data are not installed; in continuous integration that is a
/// failure, lest nobody notice.
#define GRATICULE_NEEDS_DATA()                                                             \
  if (!std::filesystem::is_directory(std::string(GRATICULE_DATA_DIR) + "/posegraph")) {    \
    if (IsContinuousIntegration()) FAIL() << "no recorded data in " << GRATICULE_DATA_DIR; \
    GTEST_SKIP() << "no recorded data in " << GRATICULE_DATA_DIR;                          \
  }                                                                                        \
  static_assert(true, "")

}  // namespace graticule
