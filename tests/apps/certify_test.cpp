// What `solve --certify` says and does; what it proves is tested in tests/problems.

#include "command.hpp"

namespace graticule::test {
namespace {

class Certify : public CommandTest {};
class CertifyRecorded : public RecordedTest {};

TEST_F(Certify, SaysInJsonAndWordsWhatIsProved) {
  const std::string file = Write("square.g2o", kSquare);
  const Outcome solved = RunCommand({"solve", file, "--certify", "--json"});
  EXPECT_EQ(solved.exit_code, 0) << solved.err;
  const auto report = JsonOf(solved);
  const auto& certificate = report["certificate"];
  EXPECT_EQ(certificate["verdict"], "optimal");
  // Computed from residuals of its own: the last digits differ.
  EXPECT_NEAR(certificate["cost"].get<double>(), report["final_cost"].get<double>(),
              1e-9 * report["final_cost"].get<double>());
  EXPECT_LE(certificate["lower_bound"], certificate["cost"]);
  EXPECT_LT(certificate["relative_gap"], 1e-5);
  EXPECT_EQ(certificate["exact_factors"], report["factors"]);
  EXPECT_TRUE(certificate["attempts"].empty());
  EXPECT_TRUE(certificate["eigenvalue"].is_null());
  const Outcome words = RunCommand({"solve", file, "--certify", "--report", Path("page.html")});
  EXPECT_NE(words.out.find("globally optimal, proved"), std::string::npos) << words.out;
  EXPECT_NE(ReadWhole(Path("page.html")).find("Global optimality"), std::string::npos);
  EXPECT_FALSE(JsonOf(RunCommand({"solve", file, "--json"})).contains("certificate"));
}

TEST_F(Certify, SaysWhyItDoesNotApply) {
  const std::string file = Write("square.g2o", kSquare);
  const auto report =
      JsonOf(RunCommand({"solve", file, "--certify", "--config", "robust-huber", "--json"}));
  EXPECT_EQ(report["certificate"]["verdict"], "not_applicable");
  ASSERT_EQ(report["certificate"]["reasons"].size(), 1u);
  const std::string reason = report["certificate"]["reasons"][0];
  EXPECT_NE(reason.find("with loss huber"), std::string::npos) << reason;
  EXPECT_FALSE(report["certificate"].contains("cost"));
  // A loss that the options take away is none.
  ASSERT_EQ(RunCommand({"simulate", "bundle", "-o", Path("b.fg")}).exit_code, 0);
  EXPECT_EQ(JsonOf(RunCommand(
                {"solve", Path("b.fg"), "--certify", "--json"}))["certificate"]["reasons"][0],
            "no poses (se2/1, se3/1)");
}

TEST_F(CertifyRecorded, ReplacesABadMinimumInEveryOutput) {
  const Outcome solved =
      RunCommand({"solve", Recorded("MIT.g2o"), "--set", "initialise=file", "--set",
                  "max_iterations=30", "--certify", "--json", "-o", Path("solved.fg")});
  EXPECT_EQ(solved.exit_code, 0) << solved.err;
  const auto report = JsonOf(solved);
  EXPECT_NEAR(report["final_cost"], 20.5816344, 1e-6);
  EXPECT_EQ(report["certificate"]["verdict"], "optimal");
  EXPECT_EQ(report["certificate"]["improved"], true);
  ASSERT_EQ(report["certificate"]["attempts"].size(), 1u);
  EXPECT_EQ(report["certificate"]["attempts"][0]["from"], "chordal start");
  const auto again =
      JsonOf(RunCommand({"solve", Path("solved.fg"), "--set", "max_iterations=0", "--json"}));
  EXPECT_NEAR(again["initial_cost"], 20.5816344, 1e-6);
}

}  // namespace
}  // namespace graticule::test
