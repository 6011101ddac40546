// A recorded pose graph replayed with a fixed lag: what a step touches stays bounded, and what is
// left is a problem like any other.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/pose_graph/replay.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

constexpr std::size_t kLag = 100;

std::string Recorded(const std::string& name) { return GRATICULE_DATA_DIR "/posegraph/" + name; }

// Root mean square distance [m] of the poses of a graph of the plane, seen from the first.
double RmsDistance(const Graph& graph, const Values& a, const Values& b) {
  const Key first = graph.KeyOf(0);
  double sum = 0, in_a[3], in_b[3];
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    Between(true, a.At(first).data(), a.At(graph.KeyOf(id)).data(), in_a);
    Between(true, b.At(first).data(), b.At(graph.KeyOf(id)).data(), in_b);
    sum += std::pow(in_a[0] - in_b[0], 2) + std::pow(in_a[1] - in_b[1], 2);
  }
  return std::sqrt(sum / static_cast<double>(graph.VariableCount()));
}

class OnlineRecorded : public testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::is_regular_file(Recorded("M3500.g2o"))) return;
    const char* ci = std::getenv("CI");
    const std::string missing = "no recorded problems in " GRATICULE_DATA_DIR
                                "/posegraph; set GRATICULE_DATA_DIR when configuring";
    if (ci && std::string(ci) == "true") FAIL() << missing;
    GTEST_SKIP() << missing;
  }
};

TEST_F(OnlineRecorded, HasStepsOfBoundedSizeWithALag) {
  const Graph recorded = ReadProblem(Recorded("M3500.g2o"), Builtins()).graph;
  OnlineOptions options;
  options.lag["pose"] = kLag;
  Online online(Builtins(), options);
  Replay replay(recorded, &online);
  std::size_t largest = 0, marginalised = 0;
  while (!replay.IsDone()) {
    replay.Next();
    const OnlineReport report = online.Update();
    marginalised += report.marginalised;
    largest = std::max({largest, report.eliminated, report.changed, report.relinearised});
    EXPECT_TRUE(report.loose.empty());
  }
  // A pose whose loop closes just as it would leave stays for a step.
  EXPECT_LE(largest, kLag + 5);
  EXPECT_EQ(marginalised + online.Problem().VariableCount(), recorded.VariableCount());
  EXPECT_GT(replay.PassedOver(), 500u);
  EXPECT_EQ(replay.PassedOver() + online.Recorded().FactorCount(), recorded.FactorCount());

  // Inside the window the poses are where the same factors, all at once, have them; measured: 2 cm.
  online.UpdateExactly();
  const Values batch = Solve(online.Recorded()).values;
  const Graph problem = online.Problem();
  EXPECT_LT(RmsDistance(problem, *online.Latest(), batch), 0.1);

  const std::string file = testing::TempDir() + "online-lag-" + std::to_string(::getpid()) + ".fg";
  Recording recording(Builtins());
  recording.graph = problem;
  WriteProblem(file, recording);
  const Graph again = ReadProblem(file, Builtins()).graph;
  std::filesystem::remove(file);
  ASSERT_EQ(again.FactorCount(), problem.FactorCount());
  const Values values = problem.InitialValues(), read = again.InitialValues();
  EXPECT_EQ(values.Data(), read.Data());
  EXPECT_EQ(Objectives(problem, {&values}), Objectives(again, {&read}));
}

}  // namespace
}  // namespace graticule
