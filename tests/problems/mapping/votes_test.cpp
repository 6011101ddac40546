#include "graticule/problems/mapping/votes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "../../solver/expect_error.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

constexpr int kCells = kTileSide * kTileSide;

constexpr int kTile = 37;  // of the page

unsigned CountOf(const PageCounts& counts, int cell) {
  unsigned count = 0;
  for (int i = 0; i < counts.Planes(); ++i)
    count |= unsigned{counts.At(i, kTile).Test(cell % 16, cell / 16)} << i;
  return count;
}

TEST(Votes, AreCountedCellByCell) {
  std::mt19937 random(1);
  PageCounts counts;
  std::vector<unsigned> hits(kCells, 0);
  for (int round = 0; round < 600; ++round) {
    CellBits plus, minus;
    for (int cell = 0; cell < kCells; ++cell) {
      const unsigned what = random() % 8;
      if (what < 4) {
        plus.Set(cell % 16, cell / 16);
        ++hits[cell];
      } else if (what == 4 && hits[cell] > 0) {
        minus.Set(cell % 16, cell / 16);
        --hits[cell];
      }
    }
    counts.Add(kTile, plus, minus);
  }
  for (int cell = 0; cell < kCells; ++cell) EXPECT_EQ(CountOf(counts, cell), hits[cell]);
  for (int i = 0; i < counts.Planes(); ++i) EXPECT_FALSE(counts.At(i, kTile + 1).Any());
  // And counts onto counts.
  std::vector<CellBits> again;
  for (int i = 0; i < counts.Planes(); ++i) again.push_back(counts.At(i, kTile));
  counts.Add(kTile, again.data(), static_cast<int>(again.size()));
  for (int cell = 0; cell < kCells; ++cell) EXPECT_EQ(CountOf(counts, cell), 2 * hits[cell]);
  counts.Clear();
  for (int cell = 0; cell < kCells; ++cell) EXPECT_EQ(CountOf(counts, cell), 0u);
}

TEST(Votes, OfAPageThatHasNoneAreAnyNumber) {
  // Two votes, and none of one: the lowest plane is made though nothing is in it.
  for (const int plane : {1, 3}) {
    PageCounts counts;
    CellBits plus[4];
    plus[plane].Set(5, 6);
    counts.Add(kTile, plus, 4);
    EXPECT_EQ(CountOf(counts, 6 * 16 + 5), 1u << plane);
    EXPECT_EQ(CountOf(counts, 0), 0u);
  }
}

TEST(Votes, OfBitsAreTheirNumber) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 200; ++round) {
    CellBits bits;
    int count = 0;
    const auto density = random() % 10;
    for (int cell = 0; cell < kCells; ++cell)
      if (random() % 9 < density) {
        bits.Set(cell % 16, cell / 16);
        ++count;
      }
    EXPECT_EQ(bits.Count(), count);
  }
}

TEST(Votes, AreLabelledAsTheRuleSays) {
  std::mt19937 random(3);
  const VoteRule rules[] = {{},
                            {1, 1, 0, 1, 0, 0},
                            {15, 7, -5, 3, -4, 0},
                            {2, 1, 6, 1, 0, 0},
                            {3, 2, 0, 4, -2, 7},
                            {5, 3, 1, 2, 1, 1},
                            {4, 1, -1000, 1, 0, 0}};
  for (const VoteRule& rule : rules) {
    CheckVoteRule(rule);
    PageCounts hit_counts, pass_counts;
    std::vector<int> hits(kCells, 0), passes(kCells, 0);
    // Few votes in some cells, many in others.
    for (int round = 0; round < 40; ++round) {
      CellBits hit, passed;
      for (int cell = 0; cell < kCells; ++cell) {
        const auto what = static_cast<int>(random() % static_cast<unsigned>(4 + cell));
        if (what == 0) hit.Set(cell % 16, cell / 16), ++hits[cell];
        if (what == 1 || what == 2) passed.Set(cell % 16, cell / 16), ++passes[cell];
      }
      hit_counts.Add(kTile, hit, {});
      pass_counts.Add(kTile, passed, {});
    }
    const TileLabels labels = LabelTile(hit_counts, pass_counts, kTile, rule);
    for (int cell = 0; cell < kCells; ++cell) {
      const auto limited = [&rule](int count) {
        return rule.saturation > 0 ? std::min(count, rule.saturation) : count;
      };
      const int score = rule.hit_votes * limited(hits[cell]) -
                        rule.pass_votes * limited(passes[cell]) + rule.bias;
      const bool seen = hits[cell] + passes[cell] > 0;
      const int x = cell % 16, y = cell / 16;
      EXPECT_EQ(labels.structure.Test(x, y), seen && score >= rule.structure_from);
      EXPECT_EQ(labels.free.Test(x, y), seen && score <= rule.free_to);
      EXPECT_EQ(labels.removed.Test(x, y), labels.free.Test(x, y) && hits[cell] > 0);
    }
  }
}

TEST(Votes, RefuseRulesThatMakeNoSense) {
  const auto refused = [](const VoteRule& rule, const char* what) {
    ExpectError(ErrorKind::kUsage, {what}, [&] { CheckVoteRule(rule); });
  };
  refused({0, 1, 0, 1, 0, 0}, "hit_votes");
  refused({2, 16, 0, 1, 0, 0}, "pass_votes");
  refused({2, 1, 0, 1, 1, 0}, "free_to");
  refused({2, 1, 0, 1, 0, 6}, "saturation");
  refused({2, 1, 2000000000, 1, 0, 0}, "bias");
}

}  // namespace
}  // namespace graticule
