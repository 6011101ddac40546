// graticule map: what it writes, and what it says of broken missions.

#include <cmath>

#include "../report/markup.hpp"
#include "command.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

// A robot that drives round in a square room of 10 m, as g2o with a scan after each vertex.
std::string Room(int poses = 12) {
  constexpr int kBeams = 90;
  std::string text;
  std::vector<std::array<double, 3>> where;
  for (int i = 0; i < poses; ++i) {
    const double angle = 2 * M_PI * i / 12;
    const std::array<double, 3> pose = {2 * std::cos(angle), 2 * std::sin(angle),
                                        std::remainder(angle + M_PI / 2, 2 * M_PI)};
    where.push_back(pose);
    char line[200];
    std::snprintf(line, sizeof(line), "VERTEX_SE2 %d %.9f %.9f %.9f\n", i, pose[0], pose[1],
                  pose[2]);
    text += line;
    text += "ROBOTLASER1 0 -1.570796 3.141593 0.0352982 30 0.01 0 " + std::to_string(kBeams);
    for (int b = 0; b < kBeams; ++b) {
      const double a = pose[2] - 1.570796 + b * 0.0352982, c = std::cos(a), s = std::sin(a);
      const double x = c > 0 ? (5 - pose[0]) / c : (-5 - pose[0]) / c;
      const double y = s > 0 ? (5 - pose[1]) / s : (-5 - pose[1]) / s;
      std::snprintf(line, sizeof(line), " %.3f", std::min(std::abs(x), std::abs(y)));
      text += line;
    }
    std::snprintf(line, sizeof(line), " 0 %f %f %f %f %f %f 0 0 0 0 0 %d.5 host %d.5\n", pose[0],
                  pose[1], pose[2], pose[0], pose[1], pose[2], 10 * i, 10 * i);
    text += line;
  }
  const auto edge = [&](int a, int b) {
    const auto& p = where[static_cast<std::size_t>(a)];
    const auto& q = where[static_cast<std::size_t>(b)];
    const double c = std::cos(p[2]), s = std::sin(p[2]), dx = q[0] - p[0], dy = q[1] - p[1];
    char line[200];
    std::snprintf(line, sizeof(line), "EDGE_SE2 %d %d %.9f %.9f %.9f 400 0 0 400 0 10000\n", a, b,
                  c * dx + s * dy, c * dy - s * dx, std::remainder(q[2] - p[2], 2 * M_PI));
    text += line;
  };
  for (int i = 0; i + 1 < poses; ++i) edge(i, i + 1);
  edge(0, poses - 1);
  return text;
}

// Sweeps of a robot that moves on by 0.5 m at a time, ten a second; all but one of the readings are
// as given, the others far off.
std::string LogOfRange(const char* range, int scans) {
  std::string log;
  for (int i = 0; i < scans; ++i) {
    char line[300];
    std::snprintf(line, sizeof(line),
                  "FLASER 5 %s %s %s %s 81.83 %.2f 0 0 %.2f 0 0 %.1f host %.1f\n", range, range,
                  range, range, 0.5 * i, 0.5 * i, 0.1 * i, 0.1 * i);
    log += line;
  }
  return log;
}

class MapCommandTest : public CommandTest {};

TEST_F(MapCommandTest, WritesTheMapAndAllThatGoesWithIt) {
  const std::string log = Write("room.g2o", Room());
  const Outcome outcome = RunCommand({"map", log, "-o", Path("out"), "--datum", "42.3,-83.7",
                                      "--record", "--every", "20", "--json", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json report = JsonOf(outcome);
  EXPECT_EQ(report["schema"], "graticule-map/1");
  ASSERT_EQ(report["runs"].size(), 1u);
  EXPECT_EQ(report["runs"][0]["method"], "incremental");
  EXPECT_EQ(report["runs"][0]["updates"].size(), 6u);
  EXPECT_EQ(report["runs"][0]["updates"].back()["nodes"], 12);
  for (const char* name : {"map.yaml", "map.pgm", "map.png", "transients.yaml", "transients.pgm",
                           "transients.png", "map.pgw", "map.prj", "graph.fg", "graph.g2o",
                           "robot.tum", "drawing.svg", "drawing.png", "report.html", "report.json",
                           "trajectories.kml", "trajectories.geojson", "graphs/00006.fg"})
    EXPECT_TRUE(std::filesystem::exists(Path("out") + "/" + name)) << name;
  EXPECT_EQ(CountLines(ReadWhole(Path("out/robot.tum"))), 12u);
  EXPECT_EQ(TagFault(ReadWhole(Path("out/drawing.svg"))), "");
  EXPECT_TRUE(IsSelfContained(ReadWhole(Path("out/report.html"))));
  // On the same cells.
  std::string yaml = ReadWhole(Path("out/transients.yaml"));
  ASSERT_EQ(yaml.find("image: transients.pgm"), 0u);
  EXPECT_EQ(yaml.replace(7, 10, "map"), ReadWhole(Path("out/map.yaml")));
  EXPECT_EQ(ReadWhole(Path("out/transients.pgm")).size(), ReadWhole(Path("out/map.pgm")).size());
  // What it wrote is a problem again, and the last graph is the whole one.
  for (const char* graph : {"out/graph.fg", "out/graph.g2o", "out/graphs/00006.fg"}) {
    const Outcome solved = RunCommand({"solve", Path(graph), "--json", "--quiet"});
    ASSERT_EQ(solved.exit_code, 0) << solved.err;
    EXPECT_EQ(JsonOf(solved)["factors"], 12) << graph;
  }
}

// The walls of the room are where they are, and inside it is free.
TEST_F(MapCommandTest, DrawsTheRoom) {
  const std::string log = Write("room.g2o", Room());
  std::string truth = "P5\n102 102\n255\n";
  for (int y = 0; y < 102; ++y)
    for (int x = 0; x < 102; ++x) truth += x == 0 || y == 0 || x == 101 || y == 101 ? '\0' : '\xfe';
  Write("truth.pgm", truth);
  const std::string yaml =
      Write("truth.yaml", "image: truth.pgm\nresolution: 0.1\norigin: [-5.1, -5.1, 0]\n");
  const Outcome outcome = RunCommand(
      {"map", log, "-o", Path("out"), "--truth", yaml, "--no-cover", "--json", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  double precision = 0, recall = 0;
  const std::string said = JsonOf(outcome)["facts"]["truth"];
  ASSERT_EQ(std::sscanf(said.substr(said.find("; free ")).c_str(),
                        "; free precision %lf, recall %lf", &precision, &recall),
            2);
  EXPECT_GT(precision, 0.99);
  EXPECT_GT(recall, 0.95);
}

TEST_F(MapCommandTest, TheMethodsMakeTheSameMap) {
  const std::string log = Write("room.g2o", Room());
  std::string maps[2];
  for (const int i : {0, 1}) {
    const std::string out = Path("out" + std::to_string(i));
    const Outcome outcome = RunCommand(
        {"map", log, "-o", out, "--method", i == 0 ? "incremental" : "cover-composite", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    maps[i] = ReadWhole(out + "/map.pgm");
  }
  EXPECT_EQ(maps[0], maps[1]);
}

// A multiple of the period that is rounded to less than the time of a scan.
TEST_F(MapCommandTest, StepsOnWhateverThePeriod) {
  const std::string log = Write("two.log", LogOfRange("2.5", 60));
  for (const char* every : {"0.1", "0.3", "0.7"}) {
    const Outcome outcome = RunCommand(
        {"map", log, "--keep-poses", "--every", every, "-o", Path("out"), "--json", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(JsonOf(outcome)["runs"][0]["updates"].back()["nodes"], 60) << every;
  }
}

TEST_F(MapCommandTest, RefusesALogOfWhichNothingCanBeDrawn) {
  const Outcome outcome = RunCommand({"map", Write("blind.log", LogOfRange("81.83", 60)),
                                      "--keep-poses", "-o", Path("out"), "--quiet"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("blind.log: the map is empty"), std::string::npos) << outcome.err;
}

TEST_F(MapCommandTest, RefusesRelationsThatAreNotOfItsLog) {
  const std::string log = Write("a.log", LogOfRange("2.5", 60));
  const std::string relations = Write("a.relations", "1000.0 1001.0 1 0 0 0 0 0\n");
  const Outcome other = RunCommand(
      {"map", log, "--keep-poses", "--relations", relations, "-o", Path("out"), "--quiet"});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_NE(other.err.find("a.relations: none of its relations"), std::string::npos) << other.err;
  const Outcome two = RunCommand({"map", log, Write("b.log", LogOfRange("2.5", 60)), "--keep-poses",
                                  "--relations", relations, "-o", Path("out"), "--quiet"});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_NE(two.err.find("goes with one log"), std::string::npos) << two.err;
}

TEST_F(MapCommandTest, SaysWhatOfAGraphItDidNotTakeAsItIs) {
  std::string room = Room();
  const std::string edge = "EDGE_SE2 0 1 1 0 0 400 0 0 400 0 10000\n";
  const std::string misspelt = Write("misspelt.g2o", room + "EDGE_SE_2" + edge.substr(8));
  const Outcome refused = RunCommand({"map", misspelt, "-o", Path("out"), "--quiet"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("EDGE_SE_2"), std::string::npos) << refused.err;
  const Outcome skipped =
      RunCommand({"map", misspelt, "--skip-unknown", "-o", Path("out"), "--json", "--quiet"});
  ASSERT_EQ(skipped.exit_code, 0) << skipped.err;
  EXPECT_NE(skipped.out.find("skipped 1 lines of EDGE_SE_2"), std::string::npos) << skipped.out;
  const std::string indefinite =
      Write("indefinite.g2o", room + "EDGE_SE2 0 2 2 0 0 400 0 0 -1 0 10000\n");
  const Outcome repaired = RunCommand(
      {"map", indefinite, "--repair-information", "-o", Path("out"), "--json", "--quiet"});
  ASSERT_EQ(repaired.exit_code, 0) << repaired.err;
  EXPECT_NE(repaired.out.find("indefinite.g2o: "), std::string::npos) << repaired.out;
}

// A mission that an update's deadline leaves behind: its work is counted when it is done.
TEST_F(MapCommandTest, CountsTheWorkThatADeadlineLeftOver) {
  const std::string log = Write("room.g2o", Room(400));
  std::size_t nodes[2] = {};
  for (const int i : {0, 1}) {
    std::vector<std::string> words = {"map", log,         "--every", "100000",
                                      "-o",  Path("out"), "--json",  "--quiet"};
    if (i == 1) words.insert(words.end(), {"--deadline", "0.001"});
    const Outcome outcome = RunCommand(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json last = JsonOf(outcome)["runs"][0]["updates"].back();
    nodes[i] = last["dirty_tiles"];
  }
  EXPECT_GT(nodes[0], 0u);
  EXPECT_GE(nodes[1], nodes[0]);
}

// The same scans at the same poses, as a log and as a graph.
TEST_F(MapCommandTest, KeepsThePosesOfALogWhereAsked) {
  const std::string room = Room();
  std::string log;
  for (std::size_t at = 0, end; at < room.size(); at = end + 1) {
    end = room.find('\n', at);
    if (room.compare(at, 12, "ROBOTLASER1 ") == 0) log += room.substr(at, end + 1 - at);
  }
  const std::string of_graph = Path("graph"), of_log = Path("log");
  ASSERT_EQ(RunCommand({"map", Write("room.g2o", room), "--no-cover", "-o", of_graph, "--quiet"})
                .exit_code,
            0);
  const std::string clf = Write("room.clf", log);
  const Outcome outcome =
      RunCommand({"map", clf, "--keep-poses", "--no-cover", "-o", of_log, "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  // But for beams that end on the border of two cells: poses have six digits here, nine there.
  const std::string a = ReadWhole(of_log + "/map.pgm"), b = ReadWhole(of_graph + "/map.pgm");
  ASSERT_EQ(a.size(), b.size());
  std::size_t differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ += a[i] != b[i];
  EXPECT_LT(differ, a.size() / 50);
  EXPECT_EQ(CountLines(ReadWhole(of_log + "/robot1.tum")), 12u);
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{clf, "--start", "0,0,0"}, {Path("room.g2o")}}) {
    std::vector<std::string> arguments = {"map", "--keep-poses", "-o", of_log, "--quiet"};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(RunCommand(arguments).exit_code, 2);
  }
}

TEST_F(MapCommandTest, SaysWhatIsWrongWithAMission) {
  const auto refused = [&](const std::string& text, int code) {
    const Outcome outcome =
        RunCommand({"map", Write("bad.g2o", text), "-o", Path("out"), "--quiet"});
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
    return outcome.err;
  };
  std::string cut = Room();
  cut.resize(cut.find("EDGE_SE2") - 300);
  EXPECT_NE(refused(cut, 3).find("bad.g2o:24:"), std::string::npos);
  std::string unfinished = Room();
  unfinished.replace(unfinished.find(" 90 "), 4, " 91 ");
  EXPECT_NE(refused(unfinished, 3).find("bad.g2o:2:"), std::string::npos);
  EXPECT_NE(refused("VERTEX_SE2 0 0 0 0\n", 3).find("bad.g2o"), std::string::npos);
  EXPECT_EQ(RunCommand({"map", Write("room.g2o", Room()), "-o", Path("out"), "--datum", "north"})
                .exit_code,
            2);
  EXPECT_EQ(RunCommand({"map", Path("none.g2o"), "-o", Path("out")}).exit_code, 3);
}

}  // namespace
}  // namespace graticule::test
