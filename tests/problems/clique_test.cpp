#include "graticule/problems/clique.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "graticule/problems/random.hpp"

namespace graticule {
namespace {

Compatibility Draw(std::size_t count, double share, RandomNumbers* random) {
  Compatibility graph(count);
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b)
      if (random->Unit() < share) graph.Set(a, b);
  return graph;
}

bool AllGoTogether(const Compatibility& graph, const std::vector<std::uint32_t>& members) {
  for (std::size_t i = 0; i < members.size(); ++i)
    for (std::size_t j = i + 1; j < members.size(); ++j)
      if (!graph.Has(members[i], members[j])) return false;
  return true;
}

// By trying every set.
std::size_t LargestByTrying(const Compatibility& graph) {
  std::size_t largest = 0;
  for (std::uint32_t set = 0; set < 1u << graph.Count(); ++set) {
    std::vector<std::uint32_t> members;
    for (std::uint32_t i = 0; i < graph.Count(); ++i)
      if (set >> i & 1) members.push_back(i);
    if (members.size() > largest && AllGoTogether(graph, members)) largest = members.size();
  }
  return largest;
}

TEST(Clique, IsTheLargestThatTryingEverySetFinds) {
  RandomNumbers random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const Compatibility graph = Draw(1 + random.Below(12), random.Unit(), &random);
    const Clique clique = FindLargestClique(graph);
    EXPECT_TRUE(clique.is_largest);
    EXPECT_TRUE(AllGoTogether(graph, clique.members));
    EXPECT_TRUE(std::is_sorted(clique.members.begin(), clique.members.end()));
    EXPECT_EQ(clique.members.size(), LargestByTrying(graph)) << "trial " << trial;
  }
}

TEST(Clique, IsFoundWhereItWasHidden) {
  RandomNumbers random(2);
  Compatibility graph = Draw(300, 0.3, &random);
  for (std::size_t a = 0; a < 300; a += 10)
    for (std::size_t b = a + 10; b < 300; b += 10) graph.Set(a, b);
  const Clique clique = FindLargestClique(graph);
  EXPECT_TRUE(clique.is_largest);
  ASSERT_EQ(clique.members.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(clique.members[i], 10 * i);
}

TEST(Clique, IsStillOneWhereTheWorkEndsEarly) {
  RandomNumbers random(3);
  const Compatibility graph = Draw(400, 0.9, &random);
  const Clique clique = FindLargestClique(graph, 100000);
  EXPECT_FALSE(clique.is_largest);
  EXPECT_TRUE(AllGoTogether(graph, clique.members));
  EXPECT_GE(clique.members.size(), 20u);
  EXPECT_EQ(FindLargestClique(graph, 100000).members, clique.members);
}

TEST(Clique, OfNothingIsEmpty) {
  EXPECT_TRUE(FindLargestClique(Compatibility(0)).members.empty());
  EXPECT_EQ(FindLargestClique(Compatibility(3)).members.size(), 1u);
}

}  // namespace
}  // namespace graticule
