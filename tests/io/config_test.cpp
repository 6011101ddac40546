#include "graticule/io/config.hpp"

#include <gtest/gtest.h>

#include "graphs.hpp"

namespace graticule {
namespace {

TEST(Config, ReadsNamesAndValuesWithTheirPlaces) {
  const std::vector<ConfigEntry> entries = ParseConfig(
      "# a solver\nmax_iterations: 50\n\n  \nlinear_algebra:  \"eigen sparse\"  # quoted\n", "a");
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].name, "max_iterations");
  EXPECT_EQ(entries[0].value, "50");
  EXPECT_EQ(entries[0].line, 2u);
  EXPECT_EQ(entries[0].column, 1u);
  EXPECT_EQ(entries[1].value, "eigen sparse");
  EXPECT_EQ(entries[1].line, 5u);
}

TEST(Config, TakesAnEmptyFileAsNoEntries) {
  for (const char* text : {"", "\n", "# nothing\n", "---\n", "{}"})
    EXPECT_TRUE(ParseConfig(text, "a").empty()) << text;
}

TEST(Config, ReadsOneLineOfJson) { EXPECT_EQ(ParseConfig("{\"a\": 1, \"b\": 2}", "a").size(), 2u); }

}  // namespace
}  // namespace graticule
