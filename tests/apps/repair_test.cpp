// `--repair-information`: every command that reads a problem takes it, and says what it did.

#include <cmath>

#include "../report/markup.hpp"
#include "command.hpp"

namespace graticule::test {
namespace {

class Repair : public CommandTest {
 protected:
  // The square, and a fifth edge whose information has the eigenvalues -1, 3 and 1.
  std::string Bad() const {
    return Write("bad.g2o", std::string(kSquare) + "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n");
  }
};

const char* const kSaid = "not positive definite and was repaired: smallest eigenvalue -1, ";

TEST_F(Repair, IsNamedWhereAFileIsRefusedForWantOfIt) {
  const std::string file = Bad();
  for (const std::vector<std::string>& words : {std::vector<std::string>{"solve", file},
                                                {"convert", file, Path("out.fg")},
                                                {"inspect", file},
                                                {"check", file},
                                                {"compare", file, "--configs", "default"}}) {
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 3) << words[0];
    EXPECT_NE(outcome.err.find("in this file is not, smallest eigenvalue -1); "
                               "--repair-information takes"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
  }
}

TEST_F(Repair, IsSaidByEveryCommand) {
  const std::string file = Bad();
  for (const std::vector<std::string>& words : {std::vector<std::string>{"solve", file, "--json"},
                                                {"inspect", file, "--json"},
                                                {"check", file, "--json"}}) {
    SCOPED_TRACE(words[0]);
    std::vector<std::string> with = words;
    with.emplace_back("--repair-information");
    const Outcome outcome = RunCommand(with);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find(kSaid), std::string::npos) << outcome.err;
    const auto json = JsonOf(outcome)["repaired_information"];
    EXPECT_EQ(json["count"], 1);
    EXPECT_NEAR(json["smallest_eigenvalue"].get<double>(), -1, 1e-12);
    EXPECT_NEAR(json["largest_change"].get<double>(), 1 / std::sqrt(11), 1e-8);
    EXPECT_EQ(json["first"].get<std::string>().find(file + ":"), 0u) << json;
    with.erase(with.end() - 2);  // without --json
    EXPECT_NE(RunCommand(with).out.find(kSaid), std::string::npos);
  }
}

TEST_F(Repair, IsInEveryReport) {
  const std::string file = Bad();
  ASSERT_EQ(
      RunCommand({"solve", file, "--repair-information", "--report", Path("solve.html")}).exit_code,
      0);
  EXPECT_NE(ReadWhole(Path("solve.html")).find(kSaid), std::string::npos);
  const std::vector<std::string> compare = {
      "compare", file, "--configs", "default", "dogleg", "--repeats", "1", "--repair-information"};
  for (const char* report : {"compare.html", "compare.json"}) {
    std::vector<std::string> words = compare;
    words.insert(words.end(), {"--report", Path(report)});
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("1 of 5 information matrices was"), std::string::npos)
        << outcome.out;
  }
  const std::string page = ReadWhole(Path("compare.html"));
  EXPECT_EQ(TagFault(page), "");
  EXPECT_NE(page.find(kSaid), std::string::npos);
  const auto runs = nlohmann::json::parse(ReadWhole(Path("compare.json")))["runs"];
  for (const auto& run : runs) EXPECT_EQ(run["repaired_information"]["count"], 1);
}

TEST_F(Repair, IsNeededOnce) {
  ASSERT_EQ(RunCommand({"convert", Bad(), Path("good.fg"), "--repair-information"}).exit_code, 0);
  const Outcome again = RunCommand({"solve", Path("good.fg"), "--json"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(JsonOf(again)["repaired_information"].is_null());
  EXPECT_NE(ReadWhole(Path("good.fg")).find("bad.g2o --repair-information"), std::string::npos);
  const auto before = JsonOf(RunCommand({"solve", Bad(), "--repair-information", "--json"}));
  EXPECT_EQ(JsonOf(again)["final_cost"], before["final_cost"]);
}

}  // namespace
}  // namespace graticule::test
