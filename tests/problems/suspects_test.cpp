#include "graticule/problems/pose_graph/suspects.hpp"

#include <gtest/gtest.h>

#include "../solver/expect_error.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"

namespace graticule {
namespace {

Graph Sources() {
  Graph graph(Builtins());
  const Noise noise = Noise::Sigma(0.1);
  for (std::uint64_t i = 0; i < 4; ++i) graph.Add(Key("pose", i), "se2/1", {double(i), 0, 0});
  graph.Add(Key("other", 2), "se2/1", {0, 0, 0});
  const auto between = [&](const char* a, const char* b, const char* source) {
    graph.Add(BetweenSe2Factor(Key(a), Key(b), {1, 0, 0}, noise, source));
  };
  between("pose:0", "pose:1", "odometry");  // 0
  between("pose:2", "pose:1", "");          // 1: consecutive, and nothing says otherwise
  between("pose:2", "pose:3", "loop");      // 2
  between("pose:0", "pose:2", "");          // 3
  between("pose:1", "other:2", "");         // 4: of two families
  between("pose:0", "pose:3", "odometry");  // 5
  graph.Add(Factor{"prior_se2/1", {Key("pose:0")}, {0, 0, 0}, noise, {}, "gnss"});  // 6
  return graph;
}

using Ids = std::vector<FactorId>;

TEST(Suspects, AreWhatJoinsPosesAndIsNotOdometry) {
  EXPECT_EQ(ChooseSuspects(Sources()), (Ids{2, 3, 4}));
}

TEST(Suspects, AreNamedByTheirSources) {
  EXPECT_EQ(ChooseSuspects(Sources(), {{"loop"}, {}}), (Ids{3, 4}));
  EXPECT_EQ(ChooseSuspects(Sources(), {{}, {"gnss"}}), (Ids{2, 3, 4, 6}));
  EXPECT_EQ(ChooseSuspects(Sources(), {{"loop"}, {"odometry", "gnss"}}), (Ids{0, 3, 4, 5, 6}));
}

TEST(Suspects, OfSourcesThatDoNotExistAreRefused) {
  testing::ExpectError(ErrorKind::kUsage, {"'lop'", "did you mean 'loop'?", "gnss, loop, odometry"},
                       [] {
                         ChooseSuspects(Sources(), {{"lop"}, {}});
                       });
  testing::ExpectError(ErrorKind::kUsage, {"'loop'", "both"}, [] {
    ChooseSuspects(Sources(), {{"loop"}, {"loop"}});
  });
}

}  // namespace
}  // namespace graticule
