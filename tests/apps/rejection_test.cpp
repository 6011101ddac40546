// `graticule solve --reject-outliers` and `graticule simulate corrupt`.

#include <algorithm>
#include <set>

#include "command.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

// Of the false closures, the share that was rejected; of the rejected ones, the share that is
// false.
struct Score {
  double recall = 0, precision = 0;
};

Score ScoreOf(const Json& report, const std::string& truth) {
  const std::set<std::size_t> wrong = Json::parse(ReadWhole(truth));
  double found = 0;
  for (const Json& factor : report["rejection"]["rejected"])
    found += static_cast<double>(wrong.count(factor["factor"]));
  return {found / static_cast<double>(wrong.size()),
          found / static_cast<double>(report["rejection"]["rejected"].size())};
}

class Reject : public CommandTest {
 protected:
  // Two robots, with two false closures in five.
  std::string City() {
    const Outcome made =
        RunCommand({"simulate", "city", "--robots", "2", "--poses", "200", "--outlier-fraction",
                    "0.4", "-o", Path("city.fg"), "--outliers", Path("city.json")});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return Path("city.fg");
  }
};

TEST_F(Reject, EveryMethodFindsTheFalseClosuresAndSaysWhatItDid) {
  const std::string city = City();
  for (const auto& [word, name] : {std::pair("--reject-outliers", "gnc_tls"),
                                   std::pair("--reject-outliers=gnc-tls", "gnc_tls"),
                                   std::pair("--reject-outliers=gnc-gm", "gnc_gm"),
                                   std::pair("--reject-outliers=pcm", "pcm")}) {
    const Outcome outcome = RunCommand({"solve", city, word, "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json report = JsonOf(outcome);
    const Json& rejection = report["rejection"];
    EXPECT_EQ(rejection["method"], name);
    EXPECT_EQ(rejection["suspects"].get<int>() + rejection["trusted"].get<int>(),
              report["factors"].get<int>() + static_cast<int>(rejection["rejected"].size()));
    EXPECT_EQ(rejection["suspect_sources"]["loop"].get<int>() +
                  rejection["suspect_sources"]["inter_robot"].get<int>(),
              rejection["suspects"]);
    const Score score = ScoreOf(report, Path("city.json"));
    EXPECT_GE(score.recall, 0.95) << word;
    EXPECT_GE(score.precision, 0.85) << word;
    const Json& first = rejection["rejected"][0];
    EXPECT_EQ(first["keys"].size(), 2u);
    EXPECT_EQ(first["type"], "between_se2/1");
    EXPECT_NEAR(report["reduced_chi2"].get<double>(), 1, 0.25) << word;
    for (const Json& worst : report["worst_factors"])
      for (const Json& rejected : rejection["rejected"])
        EXPECT_NE(worst["factor"], rejected["factor"]);
  }
}

TEST_F(Reject, PeopleAreToldByKeys) {
  const Outcome outcome = RunCommand({"solve", City(), "--reject-outliers"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("  suspect    "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(" loop); the others are trusted"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(" by gnc_tls in "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("between_se2/1 robot"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(" more, all of them in --json and --report"), std::string::npos);
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Reject, TheWrittenProblemKeepsTheQuestionUnlessAskedToDropIt) {
  const std::string city = City();
  const Json report = JsonOf(RunCommand({"solve", city, "--reject-outliers", "-o", Path("all.fg"),
                                         "--report", Path("page.html"), "--plot", Path("plot.svg"),
                                         "--marginals", "robot2:100", "--json"}));
  ASSERT_EQ(
      RunCommand({"solve", city, "--reject-outliers", "--drop-rejected", "-o", Path("kept.fg")})
          .exit_code,
      0);
  const auto factors = [&](const std::string& file) {
    return JsonOf(RunCommand({"inspect", Path(file), "--json"}))["factors"].get<std::size_t>();
  };
  const std::size_t rejected = report["rejection"]["rejected"].size();
  EXPECT_EQ(factors("all.fg"), factors("city.fg"));
  EXPECT_EQ(factors("kept.fg"), factors("city.fg") - rejected);
  EXPECT_EQ(factors("kept.fg"), report["factors"]);
  // What is written without them is solved.
  const Json again = JsonOf(RunCommand({"solve", Path("kept.fg"), "--json"}));
  EXPECT_NEAR(again["initial_cost"].get<double>(), report["final_cost"].get<double>(),
              1e-9 * report["final_cost"].get<double>());
  // What is written with them says which they are, and rejects the same again.
  const std::string all = ReadWhole(Path("all.fg"));
  const std::size_t begin = all.find("report    ") + 10;
  const Json line = Json::parse(all.substr(begin, all.find('\n', begin) - begin));
  ASSERT_EQ(line["rejected"].size(), rejected);
  for (std::size_t i = 0; i < rejected; ++i)
    EXPECT_EQ(line["rejected"][i], report["rejection"]["rejected"][i]["factor"]);
  const Json rejects = JsonOf(RunCommand({"solve", Path("all.fg"), "--reject-outliers", "--json"}));
  EXPECT_EQ(rejects["rejection"]["rejected"], report["rejection"]["rejected"]);
  EXPECT_NE(ReadWhole(Path("page.html")).find("Rejected factors"), std::string::npos);
  EXPECT_TRUE(report["marginals"].contains("covariances"));
}

TEST_F(Reject, SourcesAreTrustedAndSuspectedByName) {
  const std::string city = City();
  const Json trusted =
      JsonOf(RunCommand({"solve", city, "--reject-outliers", "--trust", "loop", "--json"}));
  EXPECT_FALSE(trusted["rejection"]["suspect_sources"].contains("loop"));
  const Json suspected = JsonOf(RunCommand({"solve", city, "--reject-outliers=gnc-gm", "--suspect",
                                            "odometry", "--trust", "loop,inter_robot", "--json"}));
  EXPECT_EQ(suspected["rejection"]["suspect_sources"].size(), 1u);
  EXPECT_TRUE(suspected["rejection"]["suspect_sources"].contains("odometry"));
}

TEST_F(Reject, WordsThatMakeNoSenseAreUsageErrors) {
  const std::string city = City(), square = Write("square.g2o", kSquare);
  const auto refused = [&](std::vector<std::string> words, const std::string& part) {
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  };
  refused({"solve", city, "--reject-outliers=ransac"}, "ransac");
  refused({"solve", city, "--reject-outliers", "--trust", "lop"}, "did you mean 'loop'?");
  refused({"solve", city, "--reject-outliers", "--trust", "loop,inter_robot"},
          "no factor is suspect");
  refused({"solve", city, "--trust", "loop"}, "--trust needs --reject-outliers");
  refused({"solve", city, "--drop-rejected"}, "--drop-rejected needs --reject-outliers");
  refused({"solve", city, "--set", "reject_outliers=gnc_tls", "--set", "inlier_quantile=1.5"},
          "inlier_quantile");
  refused({"simulate", "corrupt", "-o", Path("bad.g2o")}, "IN is required");
  refused({"simulate", "corrupt", square, "-o", Path("bad.g2o")}, "--outlier-fraction");
  refused({"simulate", "city", square, "-o", Path("bad.g2o")}, square);
  refused({"simulate", "corrupt", square, "-o", Path("bad.g2o"), "--outlier-fraction", "0.3",
           "--truth", Path("t.tum")},
          "--truth");
  EXPECT_EQ(RunCommand({"simulate", "corrupt", Path("no.g2o"), "-o", Path("bad.g2o"),
                        "--outlier-fraction", "0.3"})
                .exit_code,
            3);
  EXPECT_EQ(std::filesystem::exists(Path("bad.g2o")), false);
}

class RejectRecorded : public RecordedTest {
 protected:
  Json Corrupted(const std::string& file, const std::string& fraction,
                 std::vector<std::string> more = {}) {
    const Outcome made =
        RunCommand({"simulate", "corrupt", Recorded(file), "--outlier-fraction", fraction, "--seed",
                    "7", "-o", Path("bad.g2o"), "--outliers", Path("bad.json")});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    more.insert(more.begin(), {"solve", Path("bad.g2o"), "--json"});
    return JsonOf(RunCommand(more));
  }
};

TEST_F(RejectRecorded, TheSameSeedGivesTheSameFile) {
  const auto corrupt = [&](const char* seed, const char* output) {
    const Outcome made =
        RunCommand({"simulate", "corrupt", Recorded("CSAIL.g2o"), "--outlier-fraction", "0.3",
                    "--outlier-kind", "grouped", "--seed", seed, "-o", Path(output)});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return ReadWhole(Path(output));
  };
  const std::string first = corrupt("1", "a.fg");
  EXPECT_EQ(first, corrupt("1", "b.fg"));
  EXPECT_NE(first, corrupt("2", "b.fg"));
}

// The clean optima's costs are those of the manifest.  A false closure that agrees with the optimum
// by chance cannot be told; it adds half its limit at most.
TEST_F(RejectRecorded, FalseClosuresAreFoundWhereTheyAreTheMinorityAndBeyond) {
  constexpr double kLimit2D = 11.35,
                   kLimit3D = 16.82;  // 0.99 quantiles, 3 and 6 degrees of freedom
  const struct {
    const char *file, *fraction;
    double best_known, limit;
  } cases[] = {{"intel.g2o", "0.3", 22.5023479, kLimit2D},
               {"intel.g2o", "0.6", 22.5023479, kLimit2D},
               {"CSAIL.g2o", "0.3", 20.2775644, kLimit2D},
               {"M3500.g2o", "0.3", 68.9564755, kLimit2D},
               {"sphere2500.g2o", "0.1", 363.574834, kLimit3D}};
  for (const auto& problem : cases) {
    SCOPED_TRACE(std::string(problem.file) + " " + problem.fraction);
    const Json report = Corrupted(problem.file, problem.fraction, {"--reject-outliers"});
    const Score score = ScoreOf(report, Path("bad.json"));
    EXPECT_GE(score.recall, 0.995);
    EXPECT_EQ(score.precision, 1);
    const double passed =
        static_cast<double>(Json::parse(ReadWhole(Path("bad.json"))).size()) * (1 - score.recall);
    const double cost = report["final_cost"];
    EXPECT_GE(cost, problem.best_known * (1 - 1e-4));
    EXPECT_LE(cost, problem.best_known * (1 + 1e-4) + passed * problem.limit / 2);
  }
}

// Side by side: least squares, Huber and Cauchy end an order of magnitude above.
TEST_F(RejectRecorded, RobustLossesAloneEndElsewhere) {
  constexpr double kBestKnown = 22.5023479;
  for (const char* configuration : {"default", "robust-huber", "robust-cauchy"}) {
    const Json report = Corrupted("intel.g2o", "0.3", {"--config", configuration});
    EXPECT_GT(report["final_objective"].get<double>(), 10 * kBestKnown) << configuration;
  }
  const Json rejected = Corrupted("intel.g2o", "0.3", {"--config", "gnc-tls"});
  EXPECT_LT(rejected["final_cost"].get<double>(), 1.1 * kBestKnown);
}

TEST_F(RejectRecorded, CompareTakesTheReadyConfigurations) {
  const Outcome outcome = RunCommand({"compare", Recorded("CSAIL.g2o"), "--repeats", "1",
                                      "--configs", "default", "gnc-tls", "pcm", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json runs = JsonOf(outcome)["runs"];
  ASSERT_EQ(runs.size(), 3u);
  // Nothing is wrong in it.
  EXPECT_NEAR(runs[1]["final_cost"].get<double>(), 20.2775644, 1e-3);
}

}  // namespace
}  // namespace graticule::test
