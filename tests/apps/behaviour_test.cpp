// What `graticule solve` promises to people and to programs.

#include <cmath>

#include "command.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

class Solve : public CommandTest {
 protected:
  std::string Square() const { return Write("square.g2o", kSquare); }
  // A pose graph that takes long enough to be stopped.
  std::string BigCity() const {
    const std::string city = Path("city.fg");
    EXPECT_EQ(RunCommand({"simulate", "city", "--robots", "10", "--poses", "10000", "-o", city,
                          "--binary"})
                  .exit_code,
              0);
    return city;
  }
};

// Two pieces that nothing joins.
constexpr const char* kPieces = R"(VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1 0 0
VERTEX_SE2 10 5 0 0
VERTEX_SE2 11 6 0 0
EDGE_SE2 0 1 1 0 0 100 0 0 100 0 400
EDGE_SE2 10 11 1 0 0 100 0 0 100 0 400
)";

// A landmark that is seen once, in one direction: nothing says how far it is.
constexpr const char* kOneBearing = R"(VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1 0 0
VERTEX_XY 5 3 2
EDGE_SE2 0 1 1 0 0 100 0 0 100 0 400
EDGE_BEARING_SE2_XY 0 5 0.6 100
)";

#ifndef GRATICULE_SHARED_LIBRARIES
TEST_F(Solve, LoadsNoReadersOfPictures) {
  RunOptions options;
  options.environment["LD_TRACE_LOADED_OBJECTS"] = "1";
  const Outcome outcome = RunCommand({"--version"}, options);
  EXPECT_NE(outcome.out.find("libcholmod"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("libopencv"), std::string::npos) << outcome.out;
}
#endif

TEST_F(Solve, SaysInJsonWhatProgramsNeed) {
  const Outcome outcome = RunCommand({"solve", Square(), "--json", "--set", "initialise=file"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  const Json report = JsonOf(outcome);  // and nothing else is on stdout
  for (const char* name : {"initial_cost", "final_cost", "initial_objective", "final_objective"})
    EXPECT_TRUE(report[name].is_number_float()) << name;
  EXPECT_EQ(report["variables"], 4);
  EXPECT_EQ(report["factors"], 4);
  EXPECT_GT(report["iterations"], 0);
  EXPECT_EQ(report["termination"], "converged");
  EXPECT_EQ(report["threads"], 1);
  EXPECT_GT(report["peak_memory_bytes"], 1000000);
  double sum = 0;
  for (const char* name : {"load", "initialise", "build", "solve", "write"}) {
    ASSERT_TRUE(report["seconds"][name].is_number()) << name;
    EXPECT_GE(report["seconds"][name], 0) << name;
    sum += report["seconds"][name].get<double>();
  }
  EXPECT_GE(report["seconds"]["total"], sum);
}

TEST_F(Solve, WritesTheSameReportToAFile) {
  const Outcome outcome =
      RunCommand({"solve", Square(), "--json", "--report", Path("report.json")});
  Json said = JsonOf(outcome), written = Json::parse(ReadWhole(Path("report.json")));
  EXPECT_EQ(said["outputs"], std::vector<std::string>{Path("report.json")});
  said.erase("outputs");
  EXPECT_EQ(said, written);
}

TEST_F(Solve, TakesSeveralSettings) {
  const Json report = JsonOf(RunCommand(
      {"solve", Square(), "--json", "--set", "max_iterations=7", "-s", "method=dogleg"}));
  EXPECT_EQ(report["options"]["max_iterations"], "7");
  EXPECT_EQ(report["options"]["method"], "dogleg");
}

TEST_F(Solve, HasNoEscapesAndNoProgressWhereNobodyWatches) {
  const std::string square = Square();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"solve", square},
        {"inspect", square},
        {"check", square},
        {"compare", square, "--configs", "default", "dogleg", "--repeats", "1"}}) {
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.out, "");
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos);
    EXPECT_EQ(outcome.err, "");
  }
}

TEST_F(Solve, ShowsProgressOnATerminalUnlessItIsToBeQuiet) {
  const std::string square = Square();
  RunOptions terminal;
  terminal.terminal_stdout = terminal.terminal_stderr = true;
  const Outcome loud = RunCommand({"solve", square, "--set", "initialise=file"}, terminal);
  EXPECT_NE(loud.err.find("iteration 1, objective"), std::string::npos) << loud.err;
  // The line is gone at the end.
  EXPECT_EQ(loud.err.substr(loud.err.size() - 4), "\r\x1b[K");
  EXPECT_EQ(RunCommand({"solve", square, "--quiet"}, terminal).err, "");
  EXPECT_EQ(RunCommand({"--quiet", "solve", square}, terminal).err, "");
}

TEST_F(Solve, ColoursTablesOnATerminalUnlessNoColorIsSet) {
  const std::vector<std::string> words = {"compare", Square(),    "--configs", "default",
                                          "dogleg",  "--repeats", "1"};
  RunOptions terminal;
  terminal.terminal_stdout = true;
  EXPECT_NE(RunCommand(words, terminal).out.find("\x1b["), std::string::npos);
  terminal.environment["NO_COLOR"] = "";  // no-color.org: set, and not empty
  EXPECT_NE(RunCommand(words, terminal).out.find("\x1b["), std::string::npos);
  terminal.environment["NO_COLOR"] = "1";
  EXPECT_EQ(RunCommand(words, terminal).out.find('\x1b'), std::string::npos);
}

TEST_F(Solve, IsQuietAboutAllButErrors) {
  const std::string with_unknown =
      Write("unknown.g2o", std::string(kSquare) + "EDGE_MAGIC 0 1 2 3\n");
  EXPECT_NE(RunCommand({"solve", with_unknown, "--skip-unknown"}).err, "");
  EXPECT_EQ(RunCommand({"solve", with_unknown, "--skip-unknown", "-q"}).err, "");
  EXPECT_NE(RunCommand({"solve", with_unknown, "-q"}).err, "");
}

TEST_F(Solve, WritesTheResultOfTooFewIterations) {
  const Outcome outcome = RunCommand({"solve", Square(), "--set", "initialise=file", "--set",
                                      "max_iterations=1", "-o", Path("out.fg"), "--json"});
  EXPECT_EQ(outcome.exit_code, 4);
  const Json report = JsonOf(outcome);
  EXPECT_EQ(report["termination"], "no_convergence");
  const Json again =
      JsonOf(RunCommand({"solve", Path("out.fg"), "--set", "initialise=file", "--json"}));
  EXPECT_EQ(again["initial_cost"], report["final_cost"]);
}

TEST_F(Solve, WritesTheResultWhenTimeIsUp) {
  const Outcome outcome = RunCommand(
      {"solve", BigCity(), "--set", "time_limit_s=1e-3", "-o", Path("out.fg"), "--json"});
  EXPECT_EQ(outcome.exit_code, 4);
  const Json report = JsonOf(outcome);
  EXPECT_EQ(report["termination"], "time_limit");
  const Json again =
      JsonOf(RunCommand({"solve", Path("out.fg"), "--json", "--set", "max_iterations=0"}));
  EXPECT_EQ(again["initial_cost"], report["final_cost"]);
}

// Linux' names of files are bytes, and so is what stands in them.
TEST_F(CommandTest, WhatIsNotUtf8IsReplacedInJson) {
  const std::string replaced = "caf\xef\xbf\xbd";
  const std::string square = Write("caf\xe9.g2o", kSquare);
  for (const char* command : {"inspect", "check", "solve"}) {
    const Outcome outcome = RunCommand({command, square, "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << command << outcome.err;
    EXPECT_NE(outcome.out.find(replaced + ".g2o"), std::string::npos) << command << outcome.out;
  }
  const std::string pieces = Write("caf\xe9-2.g2o", kPieces);
  const Outcome ill_posed = RunCommand({"solve", pieces, "--json"});
  EXPECT_EQ(ill_posed.exit_code, 5) << ill_posed.err;
  EXPECT_EQ(JsonOf(ill_posed)["schema"], "graticule-ill-posed/1");

  std::string log = "receiver,transmitter,rx_x,rx_y,tx_x,tx_y,dbm\n";
  for (int i = 1; i <= 8; ++i)
    log += "caf\xe9,b," + std::to_string(i) + ",0,0,0," + std::to_string(-40 - 3 * i) + "\n";
  const Outcome fit = RunCommand({"signal", "fit", Write("log.csv", log), "--method", "log-fit",
                                  "-o", Path("model.fg"), "--json"});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_NE(fit.out.find(replaced), std::string::npos) << fit.out;
}

TEST_F(Solve, WritesTheBestSoFarOnCtrlC) {
  RunOptions interrupted;
  interrupted.terminal_stderr = true;
  interrupted.interrupt_at = "iteration 1,";
  const Outcome outcome = RunCommand(
      {"solve", BigCity(), "-o", Path("out.fg"), "--json", "--set", "function_tolerance=0", "--set",
       "gradient_tolerance=0", "--set", "parameter_tolerance=0", "--set", "max_iterations=1000000"},
      interrupted);
  EXPECT_EQ(outcome.exit_code, 4);
  const Json report = JsonOf(outcome);
  EXPECT_EQ(report["termination"], "cancelled");
  EXPECT_LT(report["final_cost"], report["initial_cost"]);
  const Json again =
      JsonOf(RunCommand({"solve", Path("out.fg"), "--json", "--set", "max_iterations=0"}));
  EXPECT_EQ(again["initial_cost"], report["final_cost"]);
}

TEST_F(Solve, SaysInJsonWhatIsIllPosed) {
  const std::string two =
      Write("two.g2o",
            "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 0 0 0\nVERTEX_SE2 3 1 0 0\n"
            "VERTEX_SE2 9 0 0 0\n"
            "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 2 3 1 0 0 1 0 0 1 0 1\n");
  const Outcome outcome = RunCommand({"solve", two, "--json", "-o", Path("out.g2o")});
  EXPECT_EQ(outcome.exit_code, 5);
  const Json said = JsonOf(outcome);
  EXPECT_EQ(said["schema"], "graticule-ill-posed/1");
  EXPECT_EQ(outcome.err, "graticule: " + said["error"].get<std::string>() + "\n");
  ASSERT_EQ(said["pieces"].size(), 2u);
  EXPECT_EQ(said["pieces"][1]["anchor"], "pose:2");
  EXPECT_EQ(said["pieces"][1]["held_by"], "nothing");
  EXPECT_EQ(said["isolated"], Json({"pose:9"}));
  EXPECT_EQ(Files(), std::vector<std::string>{"two.g2o"});
  EXPECT_EQ(said["pieces"], JsonOf(RunCommand({"inspect", two, "--json"}))["pieces"]);
  EXPECT_EQ(RunCommand({"solve", two}).out, "");
}

TEST_F(Solve, GivesCovariancesOfTheKeysThatAreAskedFor) {
  const std::string square = Square();
  const Outcome outcome = RunCommand({"solve", square, "--marginals", "pose:1,pose:2",
                                      "--marginals-output", Path("m.json"), "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  const Json marginals = Json::parse(ReadWhole(Path("m.json")));
  EXPECT_EQ(marginals, JsonOf(outcome)["marginals"]);
  EXPECT_EQ(marginals["relative_to"], std::vector<std::string>{"pose:0"});
  ASSERT_EQ(marginals["covariances"].size(), 2u);
  const Json& block = marginals["covariances"]["pose:1"];
  EXPECT_EQ(block["fields"], (std::vector<std::string>{"x:m", "y:m", "yaw:rad"}));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(block["covariance"][i][i], 0);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_EQ(block["covariance"][i][j], block["covariance"][j][i]);
  }
  // One edge of the square of four has sigma 0.1 m; the rest of the loop only helps.
  EXPECT_LT(std::sqrt(block["covariance"][0][0].get<double>()), 0.1);

  const Json all = JsonOf(RunCommand({"solve", square, "--marginals", "all", "--json"}));
  EXPECT_EQ(all["marginals"]["covariances"].size(), 4u);
  EXPECT_EQ(all["marginals"]["covariances"]["pose:1"], block);
}

TEST_F(Solve, GivesCovariancesOfTheLossThatItSolvedWith) {
  // Two readings 0.05 m, half a sigma, to either side of where the pose ends.
  const std::string file = Write("two_readings.g2o", R"(VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1 0 0
EDGE_SE2 0 1 1.05 0 0 100 0 0 100 0 400
EDGE_SE2 0 1 0.95 0 0 100 0 0 100 0 400
)");
  const auto variance = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"solve", file, "--marginals", "pose:1", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Json block = JsonOf(RunCommand(words))["marginals"]["covariances"]["pose:1"];
    return block["covariance"][0][0].get<double>();
  };
  EXPECT_NEAR(variance({}), 1 / 200.0, 1e-9);
  // Cauchy's weight of half a sigma is 1 / (1 + 0.25).
  EXPECT_NEAR(variance({"--set", "loss=cauchy"}), 1 / 160.0, 1e-9);
}

TEST_F(Solve, RefusesKeysThatAreNotThere) {
  const std::string square = Square();
  for (const char* keys : {"pose:9", "pose:1,,pose:2", "pose", "pose:1;pose:2"}) {
    const Outcome outcome =
        RunCommand({"solve", square, "--marginals", keys, "-o", Path("out.fg")});
    EXPECT_EQ(outcome.exit_code, 2) << keys;
    EXPECT_EQ(outcome.err.compare(0, 24, "graticule: --marginals: "), 0) << outcome.err;
  }
  EXPECT_EQ(Files(), std::vector<std::string>{"square.g2o"});
}

TEST_F(Solve, NamesWhatIsLooseInAnIllPosedProblem) {
  const std::string file = Write("bearing.g2o", kOneBearing);
  const Outcome json = RunCommand({"solve", file, "--marginals", "all", "--json"});
  EXPECT_EQ(json.exit_code, 5);
  const Json loose = JsonOf(json)["marginals"]["loose"];
  ASSERT_EQ(loose.size(), 1u);
  EXPECT_EQ(loose[0]["key"], "landmark:5");
  EXPECT_EQ(loose[0]["fields"], (std::vector<std::string>{"x", "y"}));
  EXPECT_NE(json.err.find("landmark:5 along x y"), std::string::npos) << json.err;
  const Outcome text = RunCommand({"solve", file, "--marginals", "all"});
  EXPECT_EQ(text.exit_code, 5);
  EXPECT_NE(text.out.find("landmark:5 along x y"), std::string::npos) << text.out;
}

TEST_F(Solve, RefusesLoosePiecesUntilTheyAreAllowed) {
  const std::string file = Write("pieces.g2o", kPieces);
  const Outcome refused = RunCommand({"solve", file, "-o", Path("out.g2o")});
  EXPECT_EQ(refused.exit_code, 5);
  EXPECT_EQ(refused.err.compare(0, 11 + file.size() + 2, "graticule: " + file + ": "), 0)
      << refused.err;
  for (const char* part : {"2 pieces", "pose:0", "pose:10", "allow_pieces=true"})
    EXPECT_NE(refused.err.find(part), std::string::npos) << part;
  EXPECT_EQ(Files(), std::vector<std::string>{"pieces.g2o"});
  const Outcome allowed = RunCommand({"solve", file, "--set", "allow_pieces=true", "--json"});
  EXPECT_EQ(allowed.exit_code, 0);
  EXPECT_EQ(JsonOf(allowed)["anchors"], (std::vector<std::string>{"pose:0", "pose:10"}));
}

TEST_F(Solve, NamesAVariableWithoutAFactor) {
  const std::string file = Write("alone.g2o", std::string(kSquare) + "VERTEX_SE2 42 0 0 0\n");
  const Outcome outcome = RunCommand({"solve", file});
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_NE(outcome.err.find("pose:42"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
}

TEST_F(Solve, HasNoTrajectoryWithoutPoses) {
  ASSERT_EQ(RunCommand({"simulate", "bundle", "-o", Path("ring.fg")}).exit_code, 0);
  const Outcome outcome = RunCommand({"solve", Path("ring.fg"), "--trajectory", Path("out.tum")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("no poses"), std::string::npos) << outcome.err;
}

// Same input, same digits: what differs between two runs is time and memory only.
class Determinism : public RecordedTest {
 protected:
  static Json WithoutTimes(Json report) {
    for (const char* name : {"seconds", "cpu_seconds", "peak_memory_bytes", "threads", "outputs"})
      report.erase(name);
    report["options"].erase("threads");
    for (Json& row : report["history"]) row.erase("seconds");
    return report;
  }

  void ExpectTheSameEachTime(const std::string& file, bool has_poses) {
    const std::vector<std::string> names = {"out.fg", "out.tum", "out.svg"};
    std::map<std::string, std::string> first;
    Json first_report;
    for (int run = 0; run < 6; ++run) {
      std::vector<std::string> words = {
          "solve",        file,     "-o",
          Path("out.fg"), "--plot", Path("out.svg"),
          "--json",       "--set",  run < 3 ? "threads=1" : "threads=2"};
      if (has_poses) words.insert(words.end(), {"--trajectory", Path("out.tum")});
      const Outcome outcome = RunCommand(words);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      const Json report = WithoutTimes(JsonOf(outcome));
      if (run == 0) first_report = report;
      EXPECT_EQ(report, first_report) << "run " << run;
      for (const std::string& name : names) {
        if (!has_poses && name == "out.tum") continue;
        const std::string written = ReadWhole(Path(name));
        EXPECT_FALSE(written.empty()) << name;
        if (run == 0) first[name] = written;
        EXPECT_TRUE(written == first[name]) << name << " of run " << run << " differs";
      }
      if (!has_poses) continue;
      ASSERT_EQ(RunCommand({"convert", Path("out.fg"), Path("out.g2o")}).exit_code, 0);
      const std::string written = ReadWhole(Path("out.g2o"));
      if (run == 0) first["g2o"] = written;
      EXPECT_TRUE(written == first["g2o"]) << "g2o of run " << run << " differs";
    }
  }
};

TEST_F(Determinism, OfAPoseGraph) { ExpectTheSameEachTime(Recorded("sphere2500.g2o"), true); }

TEST_F(Determinism, OfABundle) {
  ExpectTheSameEachTime(Recorded("synth-problem-49-7776-pre.txt.gz"), false);
}

TEST_F(Determinism, OfASimulatedCity) {
  const std::string city = Path("city.fg");
  ASSERT_EQ(RunCommand({"simulate", "city", "--robots", "1", "--poses", "3000", "--landmarks", "50",
                        "-o", city})
                .exit_code,
            0);
  ExpectTheSameEachTime(city, true);
}

}  // namespace
}  // namespace graticule::test
