// Work that goes on where it was stopped, and work over the processes of a launcher (mpirun): the
// same answers as one process gives in one go, whatever is killed on the way.  Not shown: processes
// on several machines, and srun.

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <future>
#include <thread>

#include "command.hpp"

#ifndef GRATICULE_MPIRUN
#define GRATICULE_MPIRUN ""
#endif

namespace graticule::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

// What differs from run to run, whoever runs it.
void DropTimes(Json* json) {
  for (const char* name :
       {"seconds", "cpu_seconds", "min_total_seconds", "max_total_seconds", "peak_memory_bytes"})
    if (json->is_object()) json->erase(name);
  for (Json& member : *json)
    if (member.is_structured()) DropTimes(&member);
}

Json WithoutTimes(const Outcome& outcome) {
  Json json = JsonOf(outcome);
  DropTimes(&json);
  return json;
}

std::size_t Count(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size())
    ++count;
  return count;
}

class GoesOn : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    for (const char* name : {"a", "b", "c"})
      Write(std::string(name) + ".g2o",
            kSquare + ("EDGE_SE2 0 2 1 1 3.1" + std::to_string(*name - 'a') + " 9 0 0 9 0 9\n"));
  }

  // Nine runs, which are kept in compare.state.
  Words Compare(int repeats) const {
    return {"compare",
            Path("a.g2o"),
            Path("b.g2o"),
            Path("c.g2o"),
            "--json",
            "--repeats",
            std::to_string(repeats),
            "--state",
            Path("compare.state"),
            "--configs",
            "default",
            "dogleg",
            "gauss-newton"};
  }

  // Two rounds of replays of `simulate house`, whose values are kept in NAME.yaml.matte.state.
  Words Tune(const std::string& name) {
    if (!fs::exists(Path("house"))) {
      const Outcome made = RunCommand({"signal", "simulate", "house", "--seconds", "60", "--rate",
                                       "10", "--floor", "-70", "-o", Path("house")});
      EXPECT_EQ(made.exit_code, 0) << made.err;
    }
    return {"signal", "tune", Path("house"), "--methods",         "matte",
            "--most", "25",   "-o",          Path(name + ".yaml")};
  }

  // Runs a command, and once its state file has a heading and two values sends a signal: to the
  // process that `of` finds.
  template <class Find>
  Outcome StopMidway(const Words& words, const RunOptions& options, const std::string& state,
                     int number, const Find& of) {
    auto running = std::async(std::launch::async, RunCommand, words, options);
    const auto runs = [&] {
      return running.wait_for(std::chrono::milliseconds(2)) == std::future_status::timeout;
    };
    while (runs() && CountLines(ReadWhole(Path(state))) < 4) {
    }
    EXPECT_TRUE(runs()) << "it ended before it could be stopped";
    const pid_t process = of();
    EXPECT_GT(process, 0);
    if (process > 0) kill(process, number);
    return running.get();
  }

  // The process of this name that works in the test's folder; `variable` is of its environment.
  pid_t Find(const std::string& name, const std::string& variable = "") const {
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const fs::path process = entry.path();
      const auto has = [&](const char* file, const std::string& what) {
        return ReadWhole((process / file).string()).find(what) != std::string::npos;
      };
      if (process.filename().string().find_first_not_of("0123456789") == std::string::npos &&
          ReadWhole((process / "comm").string()) == name + "\n" &&
          has("cmdline", folder_.string()) && (variable.empty() || has("environ", variable)))
        return std::stoi(process.filename().string());
    }
    return 0;
  }
};

TEST_F(GoesOn, CompareKeepsEachRunAndDoesItNoMore) {
  const Outcome first = RunCommand(Compare(1));
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const std::string whole = ReadWhole(Path("compare.state"));
  ASSERT_EQ(CountLines(whole), 2u + 9);
  EXPECT_EQ(RunCommand(Compare(1)).out, first.out) << "times and all";
  // As if it had been stopped after two runs: these stay.
  std::size_t end = 0;
  for (int line = 0; line < 4; ++line) end = whole.find('\n', end) + 1;
  Write("compare.state", whole.substr(0, end));
  EXPECT_EQ(WithoutTimes(RunCommand(Compare(1))), WithoutTimes(first));
  EXPECT_EQ(ReadWhole(Path("compare.state")).substr(0, end), whole.substr(0, end));

  const auto refused = [&](const Words& words, const std::string& what) {
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 3) << what;
    EXPECT_NE(outcome.err.find("compare.state"), std::string::npos) << what << outcome.err;
    EXPECT_EQ(outcome.out, "") << what;
  };
  for (const std::size_t cut : {std::size_t{0}, std::size_t{30}, end + 40, whole.size() - 1}) {
    Write("compare.state", whole.substr(0, cut));
    refused(Compare(1), "cut to " + std::to_string(cut));
  }
  Write("compare.state", whole);
  refused(Compare(2), "other repeats");
  Words words = Compare(1);
  words.back() = "cgnr";
  refused(words, "another configuration");
  std::ofstream(Path("c.g2o"), std::ios::app) << "EDGE_SE2 1 3 -1 1 3.1 9 0 0 9 0 9\n";
  refused(Compare(1), "another file");
}

TEST_F(GoesOn, TuneAfterCtrlCAsIfItHadNotBeenStopped) {
  ASSERT_NE(RunCommand(Tune("whole")).exit_code, 1);
  const Outcome stopped = StopMidway(Tune("part"), {}, "part.yaml.matte.state", SIGINT,
                                     [&] { return Find("graticule"); });
  EXPECT_EQ(stopped.exit_code, 4) << stopped.err;
  EXPECT_NE(stopped.err.find("the same command goes on"), std::string::npos) << stopped.err;
  EXPECT_NE(ReadWhole(Path("part.yaml")).find("matte.lambda: "), std::string::npos);
  EXPECT_EQ(RunCommand({"signal", "evaluate", Path("house"), "--methods", "matte", "--horizons",
                        "1", "--predict-every", "9", "--config", Path("part.yaml")})
                .exit_code,
            0);
  RunCommand(Tune("part"));
  EXPECT_EQ(ReadWhole(Path("part.yaml")), ReadWhole(Path("whole.yaml")));

  // What was found is of this log and these options.
  const auto refused = [&](Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("the state of another search"), std::string::npos) << outcome.err;
  };
  refused(Tune("part"), {"--every", "3s"});
  refused(Tune("part"), {"--horizons", "2"});
  refused(Tune("part"), {"--rate", "1"});
  std::ofstream(Path("house/log.csv"), std::ios::app) << "99,robot1,robot2,3,3,8,4,-50,1\n";
  refused(Tune("part"), {});
}

// The same over processes.
class Mpirun : public GoesOn {
 protected:
  void SetUp() override {
    GoesOn::SetUp();
    if (*GRATICULE_MPIRUN) return;
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << "built without MPI";
    GTEST_SKIP() << "built without MPI";
  }

  static RunOptions On(int processes, const Words& more = {}) {
    RunOptions options;
    options.launcher = {GRATICULE_MPIRUN, "--oversubscribe", "--allow-run-as-root", "--bind-to",
                        "none"};
    options.launcher.insert(options.launcher.end(), more.begin(), more.end());
    options.launcher.insert(options.launcher.end(), {"-n", std::to_string(processes)});
    // A container may not allow one process to read another.  MPI's plug-ins leak, and are unloaded
    // before anybody could say whose the leaks are.
    options.environment = {{"OMPI_MCA_btl_vader_single_copy_mechanism", "none"},
                           {"ASAN_OPTIONS", "detect_leaks=0"}};
    return options;
  }
  pid_t Rank(int rank) const {
    return Find("graticule-mpi", "OMPI_COMM_WORLD_RANK=" + std::to_string(rank));
  }
};

TEST_F(Mpirun, ComparesAsOneProcessDoes) {
  const Json one = WithoutTimes(RunCommand(Compare(1)));
  EXPECT_EQ(one["runs"].size(), 9u);
  for (const int processes : {1, 2, 3}) {
    fs::remove(Path("compare.state"));
    const Outcome outcome = RunCommand(Compare(1), On(processes));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(WithoutTimes(outcome), one) << processes;
  }
}

TEST_F(Mpirun, TunesAsOneProcessDoes) {
  const Outcome one = RunCommand(Tune("one")), two = RunCommand(Tune("two"), On(2));
  EXPECT_EQ(two.out, one.out) << two.err;
  EXPECT_EQ(two.exit_code, one.exit_code);
  EXPECT_EQ(ReadWhole(Path("two.yaml")), ReadWhole(Path("one.yaml")));
  EXPECT_EQ(ReadWhole(Path("two.yaml.matte.state")), ReadWhole(Path("one.yaml.matte.state")));
}

TEST_F(Mpirun, ComparesOnAfterAKilledProcess) {
  const int repeats = 400;
  const Json one = WithoutTimes(RunCommand(Compare(repeats)));
  for (const int rank : {1, 0}) {
    fs::remove(Path("compare.state"));
    const Outcome killed =
        StopMidway(Compare(repeats), On(2), "compare.state", SIGKILL, [&] { return Rank(rank); });
    EXPECT_NE(killed.exit_code, 0);
    const std::string kept = ReadWhole(Path("compare.state"));
    EXPECT_LT(CountLines(kept), 2u + 9);
    const Outcome rest = RunCommand(Compare(repeats), On(2));
    EXPECT_EQ(rest.exit_code, 0) << rest.err;
    EXPECT_EQ(WithoutTimes(rest), one);
    EXPECT_EQ(ReadWhole(Path("compare.state")).substr(0, kept.size()), kept);
  }
}

TEST_F(Mpirun, TunesOnAfterAKilledProcessAndAfterSigterm) {
  RunCommand(Tune("one"));
  const std::string one = ReadWhole(Path("one.yaml"));
  EXPECT_NE(one, "");
  const Outcome killed =
      StopMidway(Tune("two"), On(2), "two.yaml.matte.state", SIGKILL, [&] { return Rank(1); });
  EXPECT_NE(killed.exit_code, 0);
  RunCommand(Tune("two"), On(2));
  EXPECT_EQ(ReadWhole(Path("two.yaml")), one);

  // Open MPI's mpirun gives its processes a second: what was found is written, what they say may be
  // lost.
  const Outcome ended = StopMidway(Tune("three"), On(3), "three.yaml.matte.state", SIGTERM, [&] {
    return Find(fs::path(GRATICULE_MPIRUN).filename().string());
  });
  EXPECT_NE(ended.exit_code, 0);
  EXPECT_NE(ReadWhole(Path("three.yaml")).find("matte.lambda: "), std::string::npos);
  RunCommand(Tune("three"), On(3));
  EXPECT_EQ(ReadWhole(Path("three.yaml")), one);

  // One process that is told to stop stops all.
  const Outcome told =
      StopMidway(Tune("four"), On(2), "four.yaml.matte.state", SIGTERM, [&] { return Rank(1); });
  EXPECT_EQ(told.exit_code, 4) << told.err;
  EXPECT_EQ(Count(told.err, "the same command goes on"), 1u) << told.err;
}

TEST_F(Mpirun, SaysOneErrorOnce) {
  Words words = Compare(1);
  words.back() = "dogged";
  const Outcome everywhere = RunCommand(words, On(3));
  EXPECT_EQ(everywhere.exit_code, 2) << everywhere.err;
  EXPECT_EQ(Count(everywhere.err, "graticule: "), 1u) << everywhere.err;
  EXPECT_EQ(everywhere.out, "");

  // The second process finds another log in its folder, without time: its replay is refused, where
  // the first's goes on for long.
  Tune("here");
  Write("log.csv", ReadWhole(Path("house/log.csv")));
  fs::create_directory(Path("other"));
  Write("other/log.csv", "receiver,transmitter,rx_x,rx_y,tx_x,tx_y,dbm\na,b,3,3,8,4,-50\n");
  const Words tune = {"signal", "tune", "log.csv", "--methods", "mrt", "-o", Path("x.yaml")};
  RunOptions options = On(1, {"-wdir", Path("")});
  options.launcher.push_back(GRATICULE_PROGRAM);
  options.launcher.insert(options.launcher.end(), tune.begin(), tune.end());
  options.launcher.insert(options.launcher.end(), {":", "-n", "1", "-wdir", Path("other")});
  const Outcome there = RunCommand(tune, options);
  EXPECT_EQ(there.exit_code, 3) << there.err;
  EXPECT_EQ(Count(there.err, "graticule: log.csv: "), 1u) << there.err;
  EXPECT_FALSE(fs::exists(Path("x.yaml")));
}

TEST_F(Mpirun, RefusesWhatDoesNotSpreadAndHelpsOnce) {
  const Outcome solve = RunCommand({"solve", Path("a.g2o"), "-o", Path("out.g2o")}, On(3));
  EXPECT_EQ(solve.exit_code, 2) << solve.err;
  EXPECT_EQ(Count(solve.err, "only compare and signal tune"), 1u) << solve.err;
  EXPECT_FALSE(fs::exists(Path("out.g2o")));
  const Outcome word = RunCommand({"compare", "--nonsense"}, On(3));
  EXPECT_EQ(word.exit_code, 2) << word.err;
  EXPECT_EQ(Count(word.err, "graticule: "), 1u) << word.err;
  for (const Words& words : {Words{"--help"}, Words{"compare", "--help"}, Words{"--version"}}) {
    const Outcome outcome = RunCommand(words, On(2));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, RunCommand(words).out);
  }
  // A script in each process may have commands of its own.
  RunOptions alone = On(2);
  alone.environment["GRATICULE_LAUNCHER"] = "none";
  EXPECT_EQ(RunCommand({"solve", Path("a.g2o")}, alone).exit_code, 0);
}

}  // namespace
}  // namespace graticule::test
