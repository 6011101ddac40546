#include "graticule/solver/options.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "expect_error.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

// Texts that an option says it accepts.
std::vector<std::string> Accepted(const OptionRow<SolveOptions>& row) {
  if (row.accepts.rfind("an integer", 0) == 0) return {"1", "7", "2147483647"};
  if (row.accepts.rfind("a number", 0) == 0) return {"0.5", "1e-09", "3", "1e+300"};
  std::vector<std::string> choices;
  std::istringstream words(row.accepts);
  for (std::string word; words >> word;)
    if (word != "|") choices.push_back(word);
  return choices;
}

TEST(SolveOptionTable, ReadsBackWhateverItAccepts) {
  for (const auto& row : SolveOptionTable())
    for (const std::string& text : Accepted(row)) {
      SolveOptions options;
      ASSERT_NO_THROW(SetOption(SolveOptionTable(), row.name, text, &options)) << row.name << text;
      EXPECT_EQ(row.get(options), text) << row.name;
      for (const auto& other : SolveOptionTable()) {
        if (other.name == row.name) continue;
        EXPECT_EQ(other.get(options), other.get(SolveOptions())) << row.name << " " << other.name;
      }
    }
}

TEST(SolveOptionTable, AcceptsItsDefaults) {
  for (const auto& row : SolveOptionTable()) {
    SolveOptions options;
    EXPECT_NO_THROW(SetOption(SolveOptionTable(), row.name, row.get(options), &options))
        << row.name;
  }
}

TEST(SolveOptionTable, RefusesWhatDoesNotFitAndSaysWhatWould) {
  for (const auto& row : SolveOptionTable())
    for (const std::string text : {"", " ", "nonsense", "-1", "nan", "inf", "1.5.2", "1 ", "TRUE",
                                   "0x10", "99999999999999999999999", "1e999"}) {
      SolveOptions options;
      if (text == "99999999999999999999999" && row.accepts.rfind("a number", 0) == 0) continue;
      ExpectError(ErrorKind::kUsage, {row.name, row.accepts, "'" + text + "'"},
                  [&] { SetOption(SolveOptionTable(), row.name, text, &options); });
      EXPECT_EQ(row.get(options), row.get(SolveOptions())) << row.name << " after " << text;
    }
}

TEST(SolveOptionTable, KeepsItsLimits) {
  SolveOptions options;
  const auto set = [&](const char* name, const char* value) {
    SetOption(SolveOptionTable(), name, value, &options);
  };
  EXPECT_NO_THROW(set("max_iterations", "0"));
  EXPECT_NO_THROW(set("time_limit_s", "0"));
  EXPECT_NO_THROW(set("function_tolerance", "0"));
  EXPECT_THROW(set("threads", "0"), Error);
  EXPECT_THROW(set("loss_scale", "0"), Error);
  EXPECT_THROW(set("initial_trust_region_radius", "0"), Error);
}

TEST(SolveOptionTable, SuggestsTheNearestName) {
  SolveOptions options;
  ExpectError(ErrorKind::kUsage, {"max_iteration'", "did you mean 'max_iterations'?"},
              [&] { SetOption(SolveOptionTable(), "max_iteration", "5", &options); });
  ExpectError(ErrorKind::kUsage, {"there is no option 'zzzzzzzzzzzzzzzzzzzzzzzzz'"},
              [&] { SetOption(SolveOptionTable(), "zzzzzzzzzzzzzzzzzzzzzzzzz", "5", &options); });
}

TEST(SolveOptionTable, HasANameAndHelpForEveryRow) {
  std::vector<std::string> names;
  for (const auto& row : SolveOptionTable()) {
    EXPECT_FALSE(row.help.empty()) << row.name;
    EXPECT_EQ(row.help.find('\n'), std::string::npos) << row.name;
    names.push_back(row.name);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

}  // namespace
}  // namespace graticule
