// The commands about files: convert, inspect, check, simulate, the lists; and what solve draws.

#include <cmath>
#include <filesystem>

#include "../report/markup.hpp"
#include "command.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

// A problem of types that are in no library, as its header describes them; with a variable that no
// factor touches.
constexpr const char* kUnknownTypes = R"(graticule-problem 1
title     a radar that is not here
encoding  text
variable  se2/1 x:m y:m yaw:rad
variable  blob/1 a:m b:m
factor    doppler/1 at:se2/1 of:blob/1 | speed:m/s

variables 3
pose:0 se2/1 0 0 0 fixed
blob:0 blob/1 1 2
blob:1 blob/1 3 4

factors 1
doppler/1 pose:0 blob:0 | 0.5 | sigma 0.1

end 4
)";

class Convert : public RecordedTest {
 protected:
  void Run(const std::vector<std::string>& words) {
    const Outcome outcome = RunCommand(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  void ExpectSame(const std::string& a, const std::string& b) {
    EXPECT_FALSE(ReadWhole(Path(a)).empty()) << a;
    EXPECT_TRUE(ReadWhole(Path(a)) == ReadWhole(Path(b))) << a << " and " << b << " differ";
  }
};

TEST_F(Convert, ComesBackToTheBitFromFgTextAndBinary) {
  for (const char* name : {"intel.g2o", "sphere2500.g2o", "victoria_park.g2o", "CSAIL.g2o"}) {
    SCOPED_TRACE(name);
    Run({"convert", Recorded(name), Path("a.g2o")});
    Run({"convert", Recorded(name), Path("a.fg")});
    Run({"convert", Path("a.fg"), Path("binary.fg"), "--binary"});
    Run({"convert", Path("binary.fg"), Path("b.fg")});
    ExpectSame("a.fg", "b.fg");
    Run({"convert", Path("b.fg"), Path("b.g2o")});
    ExpectSame("a.g2o", "b.g2o");
    Run({"convert", Path("b.g2o"), Path("c.g2o")});
    ExpectSame("b.g2o", "c.g2o");
  }
}

TEST_F(Convert, PacksWithGzipWhereTheNameSaysSo) {
  Run({"convert", Recorded("intel.g2o"), Path("a.fg")});
  Run({"convert", Recorded("intel.g2o"), Path("a.fg.gz")});
  EXPECT_LT(std::filesystem::file_size(Path("a.fg.gz")), std::filesystem::file_size(Path("a.fg")));
  Run({"convert", Path("a.fg.gz"), Path("b.fg")});
  ExpectSame("a.fg", "b.fg");
}

TEST_F(Convert, WritesToroUnderBothItsNames) {
  Run({"convert", Recorded("gtsam_w100.graph"), Path("a.graph")});
  Run({"convert", Recorded("gtsam_w100.graph"), Path("a.toro")});
  ExpectSame("a.graph", "a.toro");
}

TEST_F(Convert, KeepsThatAFileHasNoInitialGuess) {
  const Json direct = JsonOf(RunCommand({"solve", Recorded("CSAIL.g2o"), "--json"}));
  for (const char* name : {"a.fg", "a.g2o"}) {
    Run({"convert", Recorded("CSAIL.g2o"), Path(name)});
    const Json inspected = JsonOf(RunCommand({"inspect", Path(name), "--json"}));
    EXPECT_EQ(inspected["has_initial_guess"], false) << name;
    const Json solved = JsonOf(RunCommand({"solve", Path(name), "--json"}));
    EXPECT_EQ(solved["initialisation"], direct["initialisation"]) << name;
    EXPECT_EQ(solved["initial_cost"], direct["initial_cost"]) << name;
    EXPECT_EQ(solved["final_cost"], direct["final_cost"]) << name;
  }
}

TEST_F(Convert, ASolutionIsAnInitialGuess) {
  const Json solved =
      JsonOf(RunCommand({"solve", Recorded("CSAIL.g2o"), "-o", Path("a.fg"), "--json"}));
  const Json again = JsonOf(RunCommand({"solve", Path("a.fg"), "--json"}));
  EXPECT_EQ(again["initial_cost"], solved["final_cost"]);
}

class Inspect : public RecordedTest {};

TEST_F(Inspect, DescribesEveryRecordedProblem) {
  const struct {
    const char* file;
    int variables, factors;
    bool has_guess;
  } files[] = {{"intel.g2o", 1728, 2512, true},
               {"kitti_00.g2o", 4541, 4677, false},
               {"victoria_park.g2o", 6969 + 151, 6968 + 3640, true},
               {"torus3D.g2o.gz", 5000, 9048, true},
               {"gtsam_w100.graph", 100, 300, true},
               {"gtsam_dubrovnik-3-7-pre.txt", 10, 19, true}};
  for (const auto& file : files) {
    const Outcome outcome = RunCommand({"inspect", Recorded(file.file), "--json"});
    EXPECT_EQ(outcome.exit_code, 0);
    const Json json = JsonOf(outcome);
    EXPECT_EQ(json["variables"], file.variables) << file.file;
    EXPECT_EQ(json["factors"], file.factors) << file.file;
    EXPECT_EQ(json["has_initial_guess"], file.has_guess) << file.file;
    EXPECT_EQ(json["pieces"].size(), 1u) << file.file;
    const Outcome text = RunCommand({"inspect", Recorded(file.file)});
    EXPECT_NE(text.out.find(std::to_string(file.variables)), std::string::npos) << text.out;
  }
}

class Types : public CommandTest {};

TEST_F(Types, ThatAreNotInstalledAreDescribedAndCarriedButNotSolved) {
  const std::string file = Write("radar.fg", kUnknownTypes);
  const Outcome inspected = RunCommand({"inspect", file, "--json"});
  EXPECT_EQ(inspected.exit_code, 0) << inspected.err;
  const Json json = JsonOf(inspected);
  EXPECT_EQ(json["factor_types"][0]["type"], "doppler/1");
  EXPECT_EQ(json["isolated"], std::vector<std::string>{"blob:1"});
  EXPECT_NE(RunCommand({"inspect", file}).out.find("doppler/1"), std::string::npos);

  ASSERT_EQ(RunCommand({"convert", file, Path("binary.fg"), "--binary"}).exit_code, 0);
  ASSERT_EQ(RunCommand({"convert", Path("binary.fg"), Path("text.fg")}).exit_code, 0);
  EXPECT_NE(ReadWhole(Path("text.fg")).find("doppler/1 pose:0 blob:0 | 0.5 | sigma 0.1"),
            std::string::npos);

  for (const char* command : {"solve", "check"}) {
    const Outcome outcome = RunCommand({command, file});
    EXPECT_EQ(outcome.exit_code, 6) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
    EXPECT_EQ(outcome.err.compare(0, 11 + file.size() + 2, "graticule: " + file + ": "), 0)
        << outcome.err;
  }
}

TEST_F(Types, AreListedWithTheirSchemas) {
  const Outcome outcome = RunCommand({"types"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* name : {"se2/1", "se3/1", "between_se2/1", "bal_reprojection/1", "x:m y:m"})
    EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
}

TEST_F(Types, AMissingPluginIsNamed) {
  const Outcome outcome = RunCommand({"types", "--plugin", Path("libnone.so")});
  EXPECT_EQ(outcome.exit_code, 6);
  EXPECT_NE(outcome.err.find("libnone.so"), std::string::npos) << outcome.err;
}

TEST_F(Types, ConfigurationsAreAlsoLookedForWhereTheEnvironmentSays) {
  Write("mine.yaml", "max_iterations: 3\n");
  RunOptions options;
  options.environment["GRATICULE_CONFIG_PATH"] = folder_.string();
  const Json report =
      JsonOf(RunCommand({"solve", Write("a.g2o", kSquare), "--config", "mine", "--json"}, options));
  EXPECT_EQ(report["configuration"], "mine");
  EXPECT_EQ(report["options"]["max_iterations"], "3");
  EXPECT_NE(RunCommand({"options"}, options).out.find(" mine"), std::string::npos);
}

// An installed program would else read what lies there on another machine.
TEST_F(Types, TheProgramDoesNotRememberWhereConfigurationsWereWhenItWasBuilt) {
  const std::string program = ReadWhole(GRATICULE_PROGRAM);
  ASSERT_FALSE(program.empty());
  EXPECT_EQ(program.find(GRATICULE_SOURCE_DIR "/apps/configs"), std::string::npos);
}

TEST_F(Types, OptionsAreDocumentedAsTheProgramPrintsThem) {
  const Outcome outcome = RunCommand({"options", "--markdown"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.out == ReadWhole(GRATICULE_SOURCE_DIR "/docs/options.md"))
      << "renew it: graticule options --markdown > docs/options.md";
}

class Check : public RecordedTest {};

TEST_F(Check, FindsNothingWrongWithPoseGraphs) {
  for (const char* name :
       {"sphere2500.g2o", "victoria_park.g2o", "gtsam_w100.graph", "CSAIL.g2o"}) {
    const Outcome outcome = RunCommand({"check", Recorded(name), "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << name << ": " << outcome.err;
    const Json json = JsonOf(outcome);
    EXPECT_EQ(json["trouble"], "");
    for (const Json& type : json["jacobians"]) {
      EXPECT_GT(type["checked"], 0);
      EXPECT_EQ(type["wrong"], 0);
      EXPECT_EQ(type["failed"], 0);
    }
  }
}

// Nothing in a BAL file says where the cameras are and how large the world is: 7 directions.  The
// little one has 38 residuals for 48 numbers, and so 10.
TEST_F(Check, CountsTheFreeDirectionsOfABundle) {
  for (const auto& [name, directions] :
       {std::pair{"gtsam_dubrovnik-3-7-pre.txt", "10 directions"},
        std::pair{"synth-problem-49-7776-pre.txt.gz", "7 directions"}}) {
    const Outcome outcome = RunCommand({"check", Recorded(name), "--json"});
    EXPECT_EQ(outcome.exit_code, 5) << name;
    const Json json = JsonOf(outcome);
    EXPECT_NE(json["trouble"].get<std::string>().find(directions), std::string::npos)
        << json["trouble"];
    EXPECT_EQ(json["jacobians"][0]["wrong"], 0);
  }
}

class Simulate : public CommandTest {
 protected:
  std::string City(const std::string& name, const std::string& seed,
                   const std::string& dimension = "2") {
    const Outcome outcome = RunCommand({"simulate",
                                        "city",
                                        "--robots",
                                        "2",
                                        "--poses",
                                        "200",
                                        "--landmarks",
                                        "20",
                                        "--outlier-fraction",
                                        "0.1",
                                        "--dimension",
                                        dimension,
                                        "--seed",
                                        seed,
                                        "-o",
                                        Path(name + ".fg"),
                                        "--truth",
                                        Path(name + ".tum"),
                                        "--outliers",
                                        Path(name + ".json")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    return ReadWhole(Path(name + ".fg"));
  }
};

TEST_F(Simulate, MakesTheSameWorldFromTheSameSeed) {
  for (const char* dimension : {"2", "3"}) {
    const std::string first = City("a", "7", dimension), second = City("b", "7", dimension),
                      other = City("c", "8", dimension);
    EXPECT_TRUE(first == second);
    EXPECT_FALSE(first == other);
    for (const char* ending : {".robot1.tum", ".robot2.tum", ".json"})
      EXPECT_TRUE(ReadWhole(Path(std::string("a") + ending)) ==
                  ReadWhole(Path(std::string("b") + ending)))
          << ending;
    EXPECT_EQ(CountLines(ReadWhole(Path("a.robot1.tum"))), 200u);
    EXPECT_FALSE(Json::parse(ReadWhole(Path("a.json"))).empty());
  }
}

// The optimum fits the noise a little better than the truth does, by about half a chi2 per free
// number; neither can be far from the other.
TEST_F(Simulate, WritesATruthThatTheOptimumComesNearTo) {
  for (const std::vector<std::string>& kind :
       {std::vector<std::string>{"city", "--robots", "1", "--poses", "500"},
        {"bundle", "--cameras", "10", "--points", "200"}}) {
    std::vector<std::string> words = {"simulate"};
    words.insert(words.end(), kind.begin(), kind.end());
    words.insert(words.end(), {"-o", Path("a.fg"), "--truth", Path("truth.fg")});
    ASSERT_EQ(RunCommand(words).exit_code, 0);
    const Json solved = JsonOf(RunCommand({"solve", Path("a.fg"), "--json"}));
    const Json truth = JsonOf(RunCommand({"solve", Path("truth.fg"), "--json", "--set",
                                          "max_iterations=0", "--set", "initialise=file"}));
    const double at_truth = truth["initial_cost"], at_optimum = solved["final_cost"];
    EXPECT_LT(at_optimum, at_truth) << kind[0];
    // Half a chi2 of as many degrees of freedom as there are residuals: within 5 sigma.
    const double n = truth["residuals"];
    EXPECT_NEAR(at_truth, n / 2, 5 * std::sqrt(n / 2)) << kind[0];
    EXPECT_EQ(JsonOf(RunCommand({"solve", Path("truth.fg"), "--json"}))["termination"],
              "converged");
  }
}

TEST_F(Simulate, WritesNothingWhereThereIsNoTrajectoryOfTheTruth) {
  const Outcome outcome =
      RunCommand({"simulate", "bundle", "-o", Path("ring.fg"), "--truth", Path("truth.tum")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("no poses"), std::string::npos) << outcome.err;
  EXPECT_TRUE(Files().empty());
}

TEST_F(Simulate, DoesWhatItsHelpShows) {
  RunOptions here;
  here.folder = folder_.string();
  EXPECT_EQ(RunCommand({"simulate", "city", "--robots", "4", "--poses", "1000", "-o", "city.fg",
                        "--truth", "truth.tum"},
                       here)
                .exit_code,
            0);
  EXPECT_EQ(RunCommand(
                {"simulate", "bundle", "--cameras", "20", "--points", "500", "-o", "ring.fg"}, here)
                .exit_code,
            0);
  const std::string help = RunCommand({"simulate", "--help"}).out;
  EXPECT_NE(help.find("simulate bundle --cameras 20 --points 500 -o ring.fg\n"), std::string::npos)
      << help;
}

class Drawings : public CommandTest {};

TEST_F(Drawings, AreWellFormed) {
  const std::string square = Write("square.g2o", kSquare);
  const Outcome outcome = RunCommand(
      {"solve", square, "--plot", Path("plot.svg"), "--report", Path("report.html"), "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string drawing = ReadWhole(Path("plot.svg"));
  EXPECT_TRUE(drawing.compare(0, 4, "<svg") == 0 || drawing.compare(0, 5, "<?xml") == 0);
  EXPECT_EQ(TagFault(drawing), "");
  EXPECT_TRUE(IsSelfContained(drawing));
  const std::string page = ReadWhole(Path("report.html"));
  EXPECT_EQ(TagFault(page), "");
  EXPECT_TRUE(IsSelfContained(page));

  ASSERT_EQ(RunCommand({"solve", square, "--plot", Path("plot.png")}).exit_code, 0);
  EXPECT_EQ(ReadWhole(Path("plot.png")).substr(0, 8), "\x89PNG\r\n\x1a\n");
}

TEST_F(Drawings, NamesFromFilesAreEscaped) {
  const std::string square = Write("a<b>&\"c\".g2o", kSquare);
  ASSERT_EQ(RunCommand({"solve", square, "--plot", Path("plot.svg"), "--report", Path("r.html")})
                .exit_code,
            0);
  EXPECT_EQ(TagFault(ReadWhole(Path("plot.svg"))), "");
  EXPECT_EQ(TagFault(ReadWhole(Path("r.html"))), "");
  ASSERT_EQ(RunCommand({"solve", square, "--plot", Path("plot.png")}).exit_code, 0);
}

}  // namespace
}  // namespace graticule::test
