#include "graticule/solver/layout.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace graticule {
namespace {

TEST(Layout, FindsWhatWasAddedAndNothingElse) {
  // Against a plain map, with numbers from dense to far out, in random order.
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  for (const std::uint64_t spread : {200ull, 5000ull, 1ull << 40}) {
    Layout layout;
    std::map<Key, VariableId> expected;
    for (int i = 0; i < 3000; ++i) {
      const Key key(i % 3 ? "pose" : "point", random() % spread);
      const VariableId id = layout.Add(key, 3);
      EXPECT_EQ(id == Layout::kNone, !expected.emplace(key, expected.size()).second);
    }
    EXPECT_EQ(layout.Count(), expected.size());
    EXPECT_EQ(layout.DataSize(), 3 * expected.size());
    for (const auto& [key, id] : expected) {
      ASSERT_EQ(layout.Find(key), id) << key.ToString();
      EXPECT_EQ(layout.KeyOf(id), key);
    }
    for (int i = 0; i < 3000; ++i) {
      const Key key("pose", random() % spread);
      EXPECT_EQ(layout.Find(key) != Layout::kNone, expected.count(key) == 1);
    }
    EXPECT_EQ(layout.Find(Key("nobody:0")), Layout::kNone);
  }
}

TEST(Layout, KnowsTheLargestNumberOfAFamily) {
  Layout layout;
  EXPECT_EQ(layout.LargestNumber("pose"), std::nullopt);
  for (const std::uint64_t number : {0ull, 1ull << 40, 7ull}) layout.Add(Key("pose", number), 1);
  layout.Add(Key("point:3"), 1);
  EXPECT_EQ(layout.Add(Key("point:3"), 1), Layout::kNone);
  EXPECT_EQ(layout.LargestNumber("pose"), 1ull << 40);
  EXPECT_EQ(layout.LargestNumber("point"), 3u);
}

TEST(Layout, TakesTheLargestNumberWithoutATableOfThatSize) {
  Layout layout;
  EXPECT_EQ(layout.Add(Key("pose", ~std::uint64_t{0}), 1), 0u);
  EXPECT_EQ(layout.Add(Key("pose", std::uint64_t{1} << 63), 1), 1u);
  EXPECT_EQ(layout.Add(Key("pose", 0), 1), 2u);
  EXPECT_EQ(layout.Find(Key("pose", ~std::uint64_t{0})), 0u);
  EXPECT_EQ(layout.Find(Key("pose", std::uint64_t{1} << 63)), 1u);
  EXPECT_EQ(layout.Find(Key("pose", 0)), 2u);
  EXPECT_EQ(layout.Find(Key("pose", (std::uint64_t{1} << 63) + 1)), Layout::kNone);
}

TEST(Layout, GivesThePositionsInTheOrderOfTheKeys) {
  Layout layout;
  for (const char* key : {"pose:10", "pose:9", "a:3", "pose:0"}) layout.Add(Key(key), 1);
  EXPECT_EQ(layout.KeyOrder(), (std::vector<VariableId>{2, 3, 1, 0}));
}

TEST(Layout, LaysVariablesOutOneAfterTheOther) {
  Layout layout;
  layout.Add(Key("a:0"), 3);
  layout.Add(Key("b:0"), 7);
  layout.Add(Key("c:0"), 1);
  EXPECT_EQ(layout.Offset(1), 3u);
  EXPECT_EQ(layout.Size(1), 7u);
  EXPECT_EQ(layout.Offset(2), 10u);
  EXPECT_EQ(layout.DataSize(), 11u);
}

}  // namespace
}  // namespace graticule
