// `graticule compare`: what fits is solved, what does not is named, and nothing stops the rest.

#include "../report/markup.hpp"
#include "command.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

const std::vector<std::string> kReady = {"default",
                                         "gauss-newton",
                                         "levenberg-marquardt",
                                         "dogleg",
                                         "eigen-sparse",
                                         "cgnr",
                                         "sparse-schur",
                                         "iterative-schur",
                                         "robust-huber",
                                         "robust-cauchy",
                                         "gnc-tls",
                                         "gnc-gm",
                                         "pcm"};

std::vector<std::string> Compare(const std::vector<std::string>& files,
                                 const std::vector<std::string>& configurations,
                                 const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {"compare"};
  words.insert(words.end(), files.begin(), files.end());
  words.insert(words.end(), {"--repeats", "1", "--configs"});
  words.insert(words.end(), configurations.begin(), configurations.end());
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class CompareProblems : public RecordedTest {};

TEST_F(CompareProblems, SolvesTwoFilesWithEveryReadyConfiguration) {
  const std::string grid = Recorded("smallGrid3D.g2o"), ring = Recorded("ring.g2o");
  const Outcome json =
      RunCommand(Compare({grid, ring}, kReady, {"--json", "--report", Path("compare.html")}));
  EXPECT_EQ(json.exit_code, 0) << json.err;
  const Json runs = JsonOf(json)["runs"];
  ASSERT_EQ(runs.size(), 2 * kReady.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Json& run = runs[i];
    SCOPED_TRACE(run["configuration"].get<std::string>() + " of " + run["file"].get<std::string>());
    EXPECT_EQ(run["file"], i < kReady.size() ? grid : ring);
    EXPECT_EQ(run["configuration"], kReady[i % kReady.size()]);
    EXPECT_TRUE(run["error"].is_null());
    EXPECT_TRUE(run["final_cost"].is_number());
    const std::string& name = kReady[i % kReady.size()];
    const bool rejects = name == "pcm" || name.compare(0, 3, "gnc") == 0;
    EXPECT_TRUE(rejects || run["gap"] >= 0);
    for (const char* phase : {"load", "build", "solve", "total"})
      EXPECT_GT(run["seconds"][phase], 0) << phase;
    EXPECT_GT(run["peak_memory_bytes"], 0);
    // Configurations differ in how, not in what: only a loss changes the question, or what is
    // rejected.  Conjugate
    // gradients do not get there on the ring in a hundred steps, and say so.
    const double best = i < kReady.size() ? 229.076892 : 5.58155042;
    const bool robust = name.compare(0, 6, "robust") == 0;
    if (robust || rejects) continue;
    if (run["termination"] == "converged") {
      EXPECT_NEAR(run["final_cost"].get<double>(), best, 1e-4 * best);
    } else {
      EXPECT_GT(run["final_cost"].get<double>(), best);
    }
  }
  const std::string page = ReadWhole(Path("compare.html"));
  EXPECT_EQ(TagFault(page), "");
  EXPECT_TRUE(IsSelfContained(page));
  for (const std::string& name : kReady) EXPECT_NE(page.find(name), std::string::npos) << name;

  const Outcome table = RunCommand(Compare({grid}, kReady));
  EXPECT_EQ(table.exit_code, 0);
  for (const std::string& name : kReady)
    EXPECT_NE(table.out.find("\n" + name + " "), std::string::npos) << name;
}

TEST_F(CompareProblems, SolvesABundleWithWhatEliminatesPoints) {
  const std::string ring = Path("ring.fg");
  ASSERT_EQ(RunCommand({"simulate", "bundle", "-o", ring}).exit_code, 0);
  const Outcome outcome =
      RunCommand(Compare({ring}, {"default", "sparse-schur", "iterative-schur"}, {"--json"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = JsonOf(outcome);
  const double cost = json["runs"][0]["final_cost"];
  for (const Json& run : json["runs"])
    EXPECT_NEAR(run["final_cost"].get<double>(), cost, 1e-6 * cost) << run["configuration"];
}

TEST_F(CompareProblems, TakesBestKnownCostsFromAFile) {
  const std::string ring = Recorded("ring.g2o");
  const std::string known = Write("known.yaml", "ring.g2o: 2.79077521\nother.g2o: 1\n");
  const Json run = JsonOf(
      RunCommand(Compare({ring}, {"default"}, {"--json", "--best-known", known})))["runs"][0];
  EXPECT_EQ(run["best_known"], 2.79077521);
  EXPECT_NEAR(run["gap"].get<double>(), 1.0, 1e-6);
}

class CompareBadInput : public CommandTest {};

TEST_F(CompareBadInput, ABrokenFileDoesNotStopTheOthers) {
  const std::string good = Write("good.g2o", kSquare), other = Write("other.g2o", kSquare);
  const std::string bad = GRATICULE_BROKEN_DIR "/decimal_comma.g2o";
  const Outcome outcome = RunCommand(Compare({good, bad, other}, {"default"}, {"--json"}));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
  EXPECT_EQ(outcome.err.compare(0, 11 + bad.size() + 7, "graticule: " + bad + ":3:14: "), 0)
      << outcome.err;
  const Json runs = JsonOf(outcome)["runs"];
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["file"], good);
  EXPECT_EQ(runs[1]["file"], other);
}

TEST_F(CompareBadInput, AConfigurationThatDoesNotFitIsThatRunsError) {
  const std::string file = Write("square.g2o", kSquare);
  // Each option is one that exists; Ceres has no dogleg on conjugate gradients.
  const std::string odd = Write("odd.yaml", "method: dogleg\nlinear_solver: cgnr\n");
  const Outcome json = RunCommand(Compare({file}, {"default", odd, "dogleg"}, {"--json"}));
  EXPECT_EQ(json.exit_code, 1);
  const Json runs = JsonOf(json)["runs"];
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_TRUE(runs[0]["error"].is_null());
  EXPECT_NE(runs[1]["error"].get<std::string>().find("do not go together"), std::string::npos);
  EXPECT_TRUE(runs[2]["error"].is_null());
  const Outcome table = RunCommand(Compare({file}, {"default", odd}));
  EXPECT_NE(table.out.find("odd: these options do not go together"), std::string::npos)
      << table.out;
}

TEST_F(CompareBadInput, AFileInPiecesIsAnErrorOfItsRunsOnly) {
  const std::string good = Write("good.g2o", kSquare);
  const std::string alone = Write("alone.g2o", std::string(kSquare) + "VERTEX_SE2 9 0 0 0\n");
  const Outcome outcome = RunCommand(Compare({alone, good}, {"default"}, {"--json"}));
  EXPECT_EQ(outcome.exit_code, 1);
  const Json runs = JsonOf(outcome)["runs"];
  EXPECT_NE(runs[0]["error"].get<std::string>().find("pose:9"), std::string::npos);
  EXPECT_EQ(runs[1]["termination"], "converged");
}

TEST_F(CompareBadInput, AnUnknownConfigurationIsRefusedWithASuggestionBeforeAnyRun) {
  const std::string file = Write("square.g2o", kSquare);
  const Outcome outcome = RunCommand(Compare({file}, {"default", "robust-hubert"}));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("did you mean 'robust-huber'?"), std::string::npos) << outcome.err;
}

TEST_F(CompareBadInput, ACostThatIsNotANumberIsRefusedBeforeAnyRun) {
  const std::string file = Write("square.g2o", kSquare);
  const std::string known = Write("known.yaml", "square.g2o: low\n");
  const Outcome outcome = RunCommand(Compare({file}, {"default"}, {"--best-known", known}));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find(known + ":1:"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace graticule::test
