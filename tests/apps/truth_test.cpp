// `--ground-truth`: how far solutions are from the truth, in every output that says how good they
// are.

#include "../report/markup.hpp"
#include "command.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

class Truth : public CommandTest {
 protected:
  // A city of so many robots with its truth, as trajectories and as a problem.
  void Simulate(const std::string& robots, const std::string& dimension = "2") const {
    for (const char* truth : {"truth.tum", "truth.fg", "truth.g2o"})
      ASSERT_EQ(RunCommand({"simulate", "city", "--robots", robots, "--poses", "60", "--dimension",
                            dimension, "-o", Path("city.fg"), "--truth", Path(truth)})
                    .exit_code,
                0);
  }
  Outcome Solve(const std::string& truth, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"solve", Path("city.fg"), "--ground-truth", Path(truth)};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words);
  }
};

TEST_F(Truth, IsTheSameFromTrajectoriesAndFromProblems) {
  for (const char* dimension : {"2", "3"}) {
    Simulate("2", dimension);
    const Json of_tum = JsonOf(Solve("truth.tum", {"--json"}))["accuracy"];
    EXPECT_EQ(of_tum["together"]["matched"], 120);
    EXPECT_EQ(of_tum["together"]["alignment"],
              std::string("se") + dimension + " (Umeyama, no scale)");
    EXPECT_EQ(of_tum["families"].size(), 2u);
    const double ate = of_tum["together"]["ate"]["translation_m"]["rmse"];
    EXPECT_GT(ate, 1e-3);
    EXPECT_LT(ate, 1);
    for (const char* problem : {"truth.fg", "truth.g2o"}) {
      const Json of_problem = JsonOf(Solve(problem, {"--json"}))["accuracy"];
      for (const char* error : {"ate", "rpe_step", "rpe_distance"})
        for (const char* part : {"translation_m", "rotation_deg"})
          // Trajectories turn poses of the plane into quaternions.
          EXPECT_NEAR(of_problem["together"][error][part]["rmse"].get<double>(),
                      of_tum["together"][error][part]["rmse"].get<double>(), 1e-9)
              << problem << " " << error << " " << part;
    }
  }
}

TEST_F(Truth, IsReachedByTheTruth) {
  Simulate("2");
  const Json accuracy = JsonOf(RunCommand(
      {"solve", Path("truth.fg"), "--ground-truth", Path("truth.tum"), "--json", "--align", "none",
       "--set", "max_iterations=0", "--set", "initialise=file"}))["accuracy"];
  EXPECT_EQ(accuracy["together"]["alignment"], "none");
  EXPECT_LT(accuracy["together"]["ate"]["translation_m"]["max"].get<double>(), 1e-12);
  EXPECT_LT(accuracy["together"]["ate"]["rotation_deg"]["max"].get<double>(), 1e-6);
}

TEST_F(Truth, IsInTheSummaryAndThePage) {
  Simulate("2");
  const Outcome outcome =
      Solve("truth.tum", {"--report", Path("solve.html"), "--rpe-distance", "20"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* words : {"truth.tum, 120 of 120 poses, aligned: se2 (Umeyama, no scale)",
                            "ATE rmse ", "RPE rmse a step ", "over 20 m ", "robot2 by itself: "})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << " in " << outcome.out;
  const std::string page = ReadWhole(Path("solve.html"));
  EXPECT_EQ(TagFault(page), "");
  for (const char* words : {"Poses against the truth", "RPE over 20 m [m]", "robot1"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_TRUE(JsonOf(RunCommand({"solve", Path("city.fg"), "--json"}))["accuracy"].is_null());
}

TEST_F(Truth, IsComparedWithByEveryRun) {
  Simulate("2");
  std::vector<std::string> words = {"compare", Path("city.fg"),  "--configs",
                                    "default", "robust-huber",   "--repeats",
                                    "1",       "--ground-truth", Path("truth.tum")};
  const Outcome table = RunCommand(words);
  EXPECT_EQ(table.exit_code, 0) << table.err;
  for (const char* column : {" ATE ", " RPE ", "ATE of each [m]", "robot2", "truth: "})
    EXPECT_NE(table.out.find(column), std::string::npos) << column << " in " << table.out;
  words.insert(words.end(), {"--json", "--report", Path("compare.html")});
  const Json runs = JsonOf(RunCommand(words))["runs"];
  ASSERT_EQ(runs.size(), 2u);
  const Json alone = JsonOf(Solve("truth.tum", {"--json"}))["accuracy"];
  EXPECT_EQ(runs[0]["accuracy"], alone);
  EXPECT_EQ(runs[0]["ate_m"], alone["together"]["ate"]["translation_m"]["rmse"]);
  EXPECT_EQ(runs[0]["rpe_deg"], alone["together"]["rpe_step"]["rotation_deg"]["rmse"]);
  const std::string page = ReadWhole(Path("compare.html"));
  EXPECT_EQ(TagFault(page), "");
  EXPECT_NE(page.find("ATE [m]"), std::string::npos);
  EXPECT_NE(page.find("robot2"), std::string::npos);
}

TEST_F(Truth, ThatDoesNotFitIsRefusedBeforeTheSolve) {
  Simulate("2");
  const Outcome missing = Solve("nothing.tum", {"-o", Path("out.fg")});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_NE(missing.err.find("nothing.robot1.tum"), std::string::npos) << missing.err;
  Write("few.robot1.tum", "0.5 0 0 0 0 0 0 1\n");
  const Outcome few = Solve("few.tum", {"-o", Path("out.fg")});
  EXPECT_EQ(few.exit_code, 3);
  EXPECT_NE(few.err.find("few.tum: no pose has a truth"), std::string::npos) << few.err;
  Write("bad.robot1.tum", "0 0 0 0 0 0 0 zero\n");
  const Outcome bad = Solve("bad.tum", {"-o", Path("out.fg")});
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_NE(bad.err.find("bad.robot1.tum:1:15: "), std::string::npos) << bad.err;
  EXPECT_EQ(Solve("truth.tum", {"--align", "best"}).exit_code, 2);
  EXPECT_EQ(Solve("truth.tum", {"--rpe-distance", "0"}).exit_code, 2);
  for (const std::string& file : Files()) EXPECT_NE(file, "out.fg");

  ASSERT_EQ(RunCommand({"simulate", "bundle", "-o", Path("ring.fg")}).exit_code, 0);
  const Outcome bundle = RunCommand({"solve", Path("ring.fg"), "--ground-truth", Path("truth.fg")});
  EXPECT_EQ(bundle.exit_code, 2);
  EXPECT_NE(bundle.err.find("no poses"), std::string::npos) << bundle.err;

  // In a comparison it is the file that does not fit.
  const Outcome compare = RunCommand(
      {"compare", Path("city.fg"), "--configs", "default", "--ground-truth", Path("few.tum")});
  EXPECT_EQ(compare.exit_code, 3);
  EXPECT_NE(compare.err.find("no pose has a truth"), std::string::npos) << compare.err;
}

}  // namespace
}  // namespace graticule::test
