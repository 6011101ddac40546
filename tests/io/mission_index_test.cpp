#include "graticule/io/mission_index.hpp"

#include <gtest/gtest.h>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

const std::string kIndex =
    "graticule-mission 1\n"
    "title    two robots\n"
    "made-by  graticule 0.1.0 map\n"
    "datum    42.293 -83.711 260.5\n"
    "lasers   2\n"
    "-1.5 0.008726646259971648 81.09090362548828 -0.04 0 0\n"
    "0 0.5 30 0 0.1 3.1\n"
    "robots   2\n"
    "robot1 robot1 scans/robot1.g2o.gz start 1 2 0.5\n"
    "second pose scans/second.g2o.gz\n"
    "nodes    3\n"
    "robot1:0 0 0\n"
    "pose:7 1 1\n"
    "robot1:1 0 1\n"
    "graphs   2\n"
    "graphs/00001.fg 10.5 2\n"
    "graphs/00002.fg 20.25 3\n"
    "end\n";

std::string Refusal(const std::string& text) {
  try {
    ParseMissionIndex(text, "mission.index");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string With(const std::string& from, const std::string& to) {
  std::string text = kIndex;
  text.replace(text.find(from), from.size(), to);
  return Refusal(text);
}

TEST(MissionIndex, IsReadAndWrittenToTheBit) {
  const MissionIndex index = ParseMissionIndex(kIndex, "mission.index");
  EXPECT_EQ(index.title, "two robots");
  ASSERT_TRUE(index.datum);
  EXPECT_EQ(index.datum->height, 260.5);
  ASSERT_EQ(index.lasers.size(), 2u);
  EXPECT_EQ(index.lasers[0].robot_from_laser.x, -0.04);
  ASSERT_EQ(index.robots.size(), 2u);
  ASSERT_TRUE(index.robots[0].start);
  EXPECT_EQ(index.robots[0].start->yaw, 0.5);
  EXPECT_FALSE(index.robots[1].start);
  ASSERT_EQ(index.nodes.size(), 3u);
  EXPECT_EQ(index.nodes[1].key, Key("pose", 7));
  EXPECT_EQ(index.nodes[1].robot, 1u);
  EXPECT_EQ(index.nodes[1].line, 13u);
  ASSERT_EQ(index.graphs.size(), 2u);
  EXPECT_EQ(index.graphs[1].nodes, 3u);
  EXPECT_EQ(FormatMissionIndex(index), kIndex);
}

TEST(MissionIndex, RefusesAFileThatWasCutShort) {
  for (std::size_t n = 0; n + 1 < kIndex.size(); ++n)
    EXPECT_NE(Refusal(kIndex.substr(0, n)), "") << n << " bytes";
  EXPECT_NE(Refusal(kIndex + "more\n"), "");
}

TEST(MissionIndex, SaysWhatIsWrongAndWhere) {
  EXPECT_NE(With("mission 1", "mission 2").find("mission.index:1:19: expected version 1"),
            std::string::npos);
  EXPECT_NE(With("nodes    3", "nodes    2").find("mission.index:14:1: expected graphs"),
            std::string::npos);
  EXPECT_NE(With("pose:7 1 1", "pose:7 2 1").find("mission.index:13:8: expected a number below 2"),
            std::string::npos);
  EXPECT_NE(With("pose:7 1 1", "pose:7 0 1").find("the robot of this key's family"),
            std::string::npos);
  EXPECT_NE(With("pose:7 1 1", "pose:7 1 9").find("mission.index:13:10:"), std::string::npos);
  EXPECT_NE(With("robot1:1 0", "robot1:0 0").find("mission.index:14:1: expected each node once"),
            std::string::npos);
  EXPECT_NE(With("20.25 3", "10.5 3").find("mission.index:17:17: expected a time after"),
            std::string::npos);
  EXPECT_NE(With("20.25 3", "20.25 1").find("mission.index:17:23: expected 2 to 3"),
            std::string::npos);
  EXPECT_NE(With("robot1 robot1", "../robot1 robot1").find("expected a robot's name"),
            std::string::npos);
  EXPECT_NE(With("graphs/00002", "../00002").find("a file within the folder"), std::string::npos);
  EXPECT_NE(With("scans/robot1", "/scans/robot1").find("a file within the folder"),
            std::string::npos);
  EXPECT_NE(With("lasers   2", "lasers   99999999999").find("as many as there are lines"),
            std::string::npos);
}

}  // namespace
}  // namespace graticule
