// graticule map --record: a mission that is written, read back and replayed.

#include <cmath>
#include <filesystem>
#include <fstream>

#include "command.hpp"

namespace graticule::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Two robots for two minutes, located by satellites: simulated, and mapped by those tests that
// look at that.
class RecordTest : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    const Outcome outcome = RunCommand(
        {"simulate", "mission", "--robots", "2", "--minutes", "2", "--gnss", "0.5", "--bad-fixes",
         "1", "--record", "--pictures", "0", "--street-things", "0", "-o", Path("sim"), "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  void MakeMap() {
    const Outcome outcome =
        RunCommand({"map", Of("sim/robot1.log"), Of("sim/robot2.log"), "--gnss", Of("sim/gnss.csv"),
                    "--datum", "42.293,-83.711,260", "--start", "0,0,0", "--start", "1,0,0",
                    "--record", "-o", Of("map"), "--json", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    report_ = outcome.out;
  }

  std::string Of(const std::string& name) const { return Path(name); }

  // A copy to be broken.
  std::string Copy() const {
    fs::remove_all(Path("copy"));
    fs::copy(Of("sim"), Path("copy"), fs::copy_options::recursive);
    return Path("copy");
  }

  // The one line that refuses it.
  std::string Refusal(const std::string& folder) const {
    const Outcome outcome = RunCommand({"map", folder, "-o", Path("out"), "--quiet"});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
    return outcome.err;
  }

  std::string report_;
};

TEST_F(RecordTest, IsReplayedToTheSameMapByteForByte) {
  ASSERT_NO_FATAL_FAILURE(MakeMap());
  const Outcome again = RunCommand({"map", Of("map"), "-o", Path("again"), "--quiet"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  for (const char* name : {"map.pgm", "map.yaml", "map.png", "map.pgw", "map.prj", "robot1.tum",
                           "robot2.tum", "trajectories.kml", "trajectories.geojson", "drawing.png"})
    EXPECT_EQ(ReadWhole(Of("map/") + name), ReadWhole(Path("again/") + name)) << name;
  // Each step is a problem by itself, with fixes of its own datum, which no other replaces.
  EXPECT_EQ(RunCommand({"solve", Of("map/graphs/00002.fg"), "--quiet"}).exit_code, 0);
  EXPECT_EQ(
      RunCommand({"map", Of("map"), "--datum", "1,2", "-o", Path("out"), "--quiet"}).exit_code, 2);
  // And what is recorded of the replay is the recording.
  ASSERT_EQ(RunCommand({"map", Of("map"), "--record", "-o", Path("third"), "--quiet"}).exit_code,
            0);
  EXPECT_EQ(ReadWhole(Of("map/mission.index")), ReadWhole(Path("third/mission.index")));
  EXPECT_EQ(ReadWhole(Of("map/graphs/00005.fg")), ReadWhole(Path("third/graphs/00005.fg")));
  EXPECT_EQ(ReadWhole(Of("map/scans/robot2.g2o.gz")), ReadWhole(Path("third/scans/robot2.g2o.gz")));
}

TEST_F(RecordTest, IsReplayedByEveryMethodAndInLargerSteps) {
  const Outcome outcome =
      RunCommand({"map", Of("sim"), "--method", "naive", "naive-cover", "cover-composite",
                  "incremental", "--every", "30", "-o", Path("out"), "--json", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json report = JsonOf(outcome);
  ASSERT_EQ(report["runs"].size(), 4u);
  for (const Json& run : report["runs"]) EXPECT_EQ(run["updates"].size(), 4u);
}

TEST_F(RecordTest, HasAProblemAStepThatIsSolvedByItself) {
  for (const char* graph : {"sim/graphs/00001.fg", "sim/graphs/00012.fg"}) {
    const Outcome outcome = RunCommand({"solve", Of(graph), "--json", "--quiet"});
    EXPECT_EQ(outcome.exit_code, 0) << graph << outcome.err;
  }
}

// The town's frame is that of the datum: trajectories are compared with the truth as they are.
TEST_F(RecordTest, LiesWhereTheFixesSay) {
  ASSERT_NO_FATAL_FAILURE(MakeMap());
  const std::string fact = Json::parse(report_)["facts"]["gnss"];
  EXPECT_NE(fact.find("50 fixes, 1 of them"), std::string::npos) << fact;
  for (const char* robot : {"robot1", "robot2"}) {
    std::map<double, std::pair<double, double>> truth;
    double time, x, y, rest;
    std::ifstream true_file(Of("sim/truth/poses.") + robot + ".tum");
    while (true_file >> time >> x >> y >> rest >> rest >> rest >> rest >> rest)
      truth[time] = {x, y};
    std::ifstream file(Of("map/") + robot + ".tum");
    double sum = 0;
    int count = 0;
    while (file >> time >> x >> y >> rest >> rest >> rest >> rest >> rest) {
      ASSERT_TRUE(truth.count(time));
      sum += std::hypot(x - truth[time].first, y - truth[time].second);
      ++count;
    }
    ASSERT_GT(count, 20);
    // 25 fixes of 0.5 m leave 0.15 m, and of the direction 1 degree at 20 m.
    EXPECT_LT(sum / count, 0.6) << robot;
  }
}

TEST_F(RecordTest, SaysWhatIsMissingOrBroken) {
  fs::create_directories(Path("empty"));
  EXPECT_NE(Refusal(Path("empty")).find("there is no mission.index"), std::string::npos);
  std::string copy = Copy();
  fs::remove(copy + "/graphs/00003.fg");
  EXPECT_NE(Refusal(copy).find("mission.index:"), std::string::npos);
  EXPECT_NE(Refusal(copy).find("the graph graphs/00003.fg of the sequence is missing"),
            std::string::npos);
  copy = Copy();
  fs::remove(copy + "/scans/robot2.g2o.gz");
  EXPECT_NE(Refusal(copy).find("the scans scans/robot2.g2o.gz of robot2 are missing"),
            std::string::npos);
  copy = Copy();
  std::string graph = ReadWhole(copy + "/graphs/00004.fg");
  Write("copy/graphs/00004.fg", graph.substr(0, graph.size() / 2));
  EXPECT_NE(Refusal(copy).find("graphs/00004.fg"), std::string::npos);
  copy = Copy();
  const std::string index = ReadWhole(copy + "/mission.index");
  Write("copy/mission.index", index.substr(0, index.size() / 2));
  EXPECT_NE(Refusal(copy).find("mission.index:"), std::string::npos);
  // A graph of another time, which has fewer nodes.
  copy = Copy();
  fs::copy_file(copy + "/graphs/00002.fg", copy + "/graphs/00012.fg",
                fs::copy_options::overwrite_existing);
  EXPECT_NE(Refusal(copy).find("is not a pose of the plane in graphs/00012.fg"), std::string::npos);
}

TEST_F(RecordTest, SaysWhichScanHasNoNodeAndWhichNodeNoScan) {
  const std::string scan =
      "VERTEX_SE2 4711 0 0 0\nROBOTLASER1 0 -1.5 3 0.5 50 0.1 0 3 1 2 50 0 0 0 0 0 0 0 0 0 0 0 0 7 "
      "host 7\n";
  const std::string copy = Copy();
  Write("copy/scans/robot2.g2o.gz", scan);
  const std::string refusal = Refusal(copy);
  EXPECT_NE(refusal.find("robot2.g2o.gz:2:1: expected a scan of a node of robot2"),
            std::string::npos)
      << refusal;
  std::string known = scan;
  known.replace(known.find("4711"), 4, "0");
  Write("copy/scans/robot2.g2o.gz", known + known);
  EXPECT_NE(Refusal(copy).find("robot2.g2o.gz:4:1: expected one scan a node"), std::string::npos);
  Write("copy/scans/robot2.g2o.gz", known);
  EXPECT_NE(Refusal(copy).find("there is no scan of robot2:1"), std::string::npos);
}

TEST_F(RecordTest, IsNotWrittenOverItself) {
  const Outcome outcome = RunCommand({"map", Of("sim"), "--record", "-o", Of("sim"), "--quiet"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("cannot be recorded in the folder"), std::string::npos);
}

TEST_F(RecordTest, RefusesOptionsThatItCannotFollow) {
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--laser-offset", "0.1"},
                                             {"--start", "0,0,0"},
                                             {"--gnss", "log"},
                                             {"--antenna", "1,0"}}) {
    std::vector<std::string> words = {"map", Of("sim"), "-o", Path("out"), "--quiet"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(RunCommand(words).exit_code, 2) << options[0];
  }
}

// Fixes beside a mission that has a graph already: its graphs are made anew, in the datum's world.
TEST_F(RecordTest, TakesFixesAfterwards) {
  const Outcome outcome = RunCommand(
      {"map", Of("sim"), "--gnss", Of("sim/gnss.csv"), "-o", Path("out"), "--json", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(Path("out/map.prj")));
  EXPECT_TRUE(JsonOf(outcome)["facts"].contains("datum"));
}

TEST_F(RecordTest, PutsTheLaserWhereItIsTold) {
  const std::string log = Of("sim/robot1.log");
  const Outcome outcome = RunCommand(
      {"map", log, "--laser-offset", "-0.04,0.1,0.2", "-o", Path("out"), "--json", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string fact = JsonOf(outcome)["facts"]["laser"];
  EXPECT_NE(fact.find("robot1 at -0.040 m, 0.100 m"), std::string::npos) << fact;
  EXPECT_NE(fact.find("which is overridden"), std::string::npos) << fact;
  for (const char* bad : {"x", "1,2", "1,2,3,4", "nan"})
    EXPECT_EQ(
        RunCommand({"map", log, "--laser-offset", bad, "-o", Path("out"), "--quiet"}).exit_code, 2)
        << bad;
  EXPECT_EQ(RunCommand({"map", log, "--laser-offset", "1", "--laser-offset", "2", "-o", Path("out"),
                        "--quiet"})
                .exit_code,
            2);
}

}  // namespace
}  // namespace graticule::test
