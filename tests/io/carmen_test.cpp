#include "graticule/io/carmen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "graphs.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/relations.hpp"

namespace graticule {
namespace {

constexpr const char* kTimes = " 10.5 host 0.5\n";

std::string Flaser(std::size_t beams, const std::string& times = kTimes) {
  std::string line = "FLASER " + std::to_string(beams);
  for (std::size_t i = 0; i < beams; ++i) line += i == 1 ? " 81.83" : " 1.5";
  return line + " 1 2 0.5 1 2 0.5" + times;
}

CarmenSummary Parse(const std::string& text, LaserLog* log, const CarmenOptions& options = {}) {
  return ParseCarmen(text, "a.clf", options, log);
}

LaserLog Read(const std::string& text, const CarmenOptions& options = {}) {
  LaserLog log;
  Parse(text, &log, options);
  return log;
}

TEST(Carmen, ReadsFlaserWithTheStepThatItsBeamsMean) {
  const struct {
    std::size_t beams;
    double step;
  } cases[] = {{180, M_PI / 180}, {181, M_PI / 180}, {360, M_PI / 360}, {361, M_PI / 360}};
  for (const auto& c : cases) {
    const LaserLog log = Read("# comment\n" + Flaser(c.beams));
    ASSERT_EQ(log.scans.size(), 1u);
    const LaserScan& scan = log.scans[0];
    EXPECT_EQ(scan.beams, c.beams);
    EXPECT_EQ(scan.time, 10.5);
    EXPECT_EQ(scan.line, 2u);
    EXPECT_EQ(scan.odom_from_robot.yaw, 0.5);
    EXPECT_DOUBLE_EQ(log.GeometryOf(scan).step, c.step);
    EXPECT_DOUBLE_EQ(log.GeometryOf(scan).first_angle, -M_PI / 2);
  }
}

TEST(Carmen, TakesTheLargestReadingForNoReturn) {
  const LaserLog log = Read(Flaser(180));
  EXPECT_LT(log.geometries[0].max_range, 81.83);
  EXPECT_GT(log.geometries[0].max_range, 80);
}

TEST(Carmen, PutsTheLaserWhereTheLogOrTheOptionsSay) {
  const std::string text = "PARAM robot_frontlaser_offset -0.04 0 host 0\n" + Flaser(180);
  EXPECT_EQ(Read(text).geometries[0].robot_from_laser.x, -0.04);
  EXPECT_EQ(Read(Flaser(180)).geometries[0].robot_from_laser.x, 0);
  CarmenOptions options;
  options.laser_offset = PlanarPose{0.1, 0, 0};
  EXPECT_EQ(Read(text, options).geometries[0].robot_from_laser.x, 0.1);
  options.laser_offset = PlanarPose{0.1, -0.2, 0.3};
  LaserLog log;
  const CarmenSummary summary = ParseCarmen(text, "a.clf", options, &log);
  EXPECT_EQ(log.geometries[0].robot_from_laser.y, -0.2);
  EXPECT_EQ(log.geometries[0].robot_from_laser.yaw, 0.3);
  ASSERT_TRUE(summary.logged_laser_offset);
  EXPECT_EQ(summary.logged_laser_offset->x, -0.04);
}

TEST(Carmen, KeepsAGeometryForEachNumberOfBeams) {
  const LaserLog log = Read(Flaser(180) + Flaser(361) + Flaser(180));
  ASSERT_EQ(log.geometries.size(), 2u);
  EXPECT_EQ(log.scans[0].geometry, log.scans[2].geometry);
  EXPECT_NE(log.scans[0].geometry, log.scans[1].geometry);
}

constexpr const char* kRobotLaser =
    "ROBOTLASER1 0 -1.5 3 0.5 50 0.1 0 3 1 2 50 1 17 1.2 2 0 1 2 0 0 0 0 0 0 7 host 7\n";

TEST(Carmen, PutsTheLaserOfARobotLaserMessageWhereTheOptionsSay) {
  CarmenOptions options;
  options.laser_offset = PlanarPose{-0.04, 0, 0};
  LaserLog log;
  const CarmenSummary summary = ParseCarmen(kRobotLaser, "a.clf", options, &log);
  EXPECT_EQ(log.geometries[0].robot_from_laser.x, -0.04);
  EXPECT_NEAR(summary.logged_laser_offset->x, 0.2, 1e-12);
}

// Written by CARMEN's logger (carmen-devel, logwrite): degrees and minutes as NMEA has them.
constexpr const char* kGga =
    "NMEAGGA 1 104523.0 4800.774000 N 749.848800 E 1 8 1.200000 0 250.500000 0 0 0 6.5 host 6.5\n";

TEST(Carmen, ReadsTheFixesOfAReceiver) {
  CarmenOptions options;
  options.read_fixes = true;
  LaserLog log;
  std::string none = kGga;
  none.replace(none.find("E 1 8"), 5, "E 0 8");  // no fix
  std::string south = kGga;
  south.replace(south.find(" N "), 3, " S ");
  const CarmenSummary summary =
      ParseCarmen(kGga + none + south + kRobotLaser, "a.clf", options, &log);
  ASSERT_EQ(summary.fixes.size(), 2u);
  EXPECT_EQ(summary.fixes[0].time, 6.5);
  EXPECT_EQ(summary.fixes[0].robot, "robot1");
  EXPECT_NEAR(summary.fixes[0].antenna.latitude, 48.0129, 1e-12);
  EXPECT_NEAR(summary.fixes[0].antenna.longitude, 7.83081333333333, 1e-12);
  EXPECT_EQ(summary.fixes[0].antenna.height, 250.5);
  EXPECT_NEAR(summary.fixes[0].sigma_m, 1.2 * 2.5, 1e-12);
  EXPECT_NEAR(summary.fixes[1].antenna.latitude, -48.0129, 1e-12);
  options.read_fixes = false;
  LaserLog other;
  EXPECT_EQ(ParseCarmen(std::string(kGga) + kRobotLaser, "a.clf", options, &other)
                .other_messages.at("NMEAGGA"),
            1u);
}

TEST(Carmen, RefusesAFixThatIsNotOnTheEarth) {
  CarmenOptions options;
  options.read_fixes = true;
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"4800.77", "9100.77"}, {" N ", " X "}, {" 1.200000", ""}}) {
    std::string broken = kGga;
    broken.replace(broken.find(from), from.size(), to);
    LaserLog log;
    EXPECT_THROW(ParseCarmen(broken + kRobotLaser, "a.clf", options, &log), Error) << broken;
  }
}

TEST(Carmen, ReadsRobotLaserWithItsOwnGeometry) {
  const LaserLog log = Read(kRobotLaser);
  ASSERT_EQ(log.scans.size(), 1u);
  const LaserGeometry& geometry = log.geometries[0];
  EXPECT_EQ(geometry.first_angle, -1.5);
  EXPECT_EQ(geometry.step, 0.5);
  EXPECT_EQ(geometry.max_range, 50);
  EXPECT_NEAR(geometry.robot_from_laser.x, 0.2, 1e-12);
  EXPECT_EQ(log.RangesOf(log.scans[0])[1], 2.f);
}

TEST(Carmen, ReadsOneOfSeveralLasersAndCountsTheRest) {
  LaserLog log;
  const CarmenSummary summary =
      Parse(std::string(kRobotLaser) + Flaser(180) + "NEFF 12\nODOM 1 2 3\n", &log);
  EXPECT_EQ(summary.laser, "ROBOTLASER1");
  EXPECT_EQ(summary.scans, 1u);
  EXPECT_EQ(summary.other_messages.at("FLASER"), 1u);
  EXPECT_EQ(summary.other_messages.at("NEFF"), 1u);
  CarmenOptions options;
  options.laser = "FLASER";
  EXPECT_EQ(Read(std::string(kRobotLaser) + Flaser(180), options).scans[0].beams, 180u);
}

TEST(Carmen, InterpolatesOdometryForRawLaser) {
  const std::string text =
      "ODOM 0 0 0 0 0 0 1 host 1\n"
      "RAWLASER1 0 -1.5 3 0.5 50 0.1 0 2 1 2 0 2 host 2\n"
      "ODOM 4 8 0.4 0 0 0 5 host 5\n";
  const LaserLog log = Read(text);
  EXPECT_DOUBLE_EQ(log.scans[0].odom_from_robot.x, 1);
  EXPECT_DOUBLE_EQ(log.scans[0].odom_from_robot.y, 2);
  EXPECT_DOUBLE_EQ(log.scans[0].odom_from_robot.yaw, 0.1);
  EXPECT_NE(MessageOf([&] {
              Read("RAWLASER1 0 -1.5 3 0.5 50 0.1 0 2 1 2 0 2 host 2\n");
            }).find("no ODOM message"),
            std::string::npos);
}

TEST(Carmen, FallsBackToTheLoggersTimesAndThenToNumbers) {
  std::string six_digits, none;
  for (int i = 0; i < 10; ++i) {
    six_digits += Flaser(180, " 1.03175e+09 host " + std::to_string(i) + ".5\n");
    none += Flaser(180, " 0 host 0\n");
  }
  LaserLog log;
  EXPECT_EQ(Parse(six_digits, &log).times, LogTimes::kLogger);
  EXPECT_EQ(log.scans[3].time, 3.5);
  log = {};
  EXPECT_EQ(Parse(none, &log).times, LogTimes::kNone);
  EXPECT_EQ(log.scans[3].time, 3);
}

TEST(Carmen, BearsTheJitterOfOldClocks) {
  const std::string text =
      Flaser(180, " 10 h 1\n") + Flaser(180, " 9.5 h 2\n") + Flaser(180, " 11 h 3\n");
  LaserLog log;
  CarmenOptions options;
  EXPECT_EQ(Parse(text, &log, options).scans, 3u);
}

TEST(Carmen, PassesOverBadLinesWhereAskedTo) {
  const std::string text = Flaser(180, " 10 h 10\n") + "FLASER 180 1 2 3\n" +
                           Flaser(180, " 11 h 11\n") + "FLASER 2 nan 1 1 2 3 1 2 3 11 h 1\n" +
                           Flaser(180, " 2 h 2\n");
  EXPECT_THROW(Read(text), Error);
  CarmenOptions options;
  options.skip_bad = true;
  LaserLog log;
  const CarmenSummary summary = Parse(text, &log, options);
  EXPECT_EQ(summary.scans, 2u);
  EXPECT_EQ(summary.skipped, 3u);
  EXPECT_NE(summary.first_skipped.find("a.clf:2:"), std::string::npos) << summary.first_skipped;
  EXPECT_EQ(log.ranges.size() % 180, 0u);
}

TEST(Carmen, AppendsRobots) {
  LaserLog log = Read(Flaser(180));
  Parse(Flaser(361), &log);
  EXPECT_EQ(log.robots, (std::vector<std::string>{"robot1", "robot2"}));
  EXPECT_EQ(log.scans[1].robot, 1u);
  EXPECT_EQ(log.RangesOf(log.scans[1])[0], 1.5f);
  EXPECT_EQ(log.GeometryOf(log.scans[1]).step, M_PI / 360);
  CarmenOptions options;
  options.robot = "robot1";
  EXPECT_THROW(Parse(Flaser(180), &log, options), Error);
  options.robot = "not a family";
  EXPECT_THROW(Parse(Flaser(180), &log, options), Error);
  EXPECT_EQ(log.robots.size(), 2u);
}

TEST(Carmen, ReadsWhatItWrote) {
  LaserLog log =
      Read(std::string(kRobotLaser) +
           "ROBOTLASER1 0 -1.5 3 0.5 50 0.1 0 2 1 2.25 0 3 3 1 3 2.8 1 0 0 0 0 0 8 h 8\n");
  const LaserLog back = Read(FormatCarmen(log));
  ASSERT_EQ(back.scans.size(), 2u);
  EXPECT_EQ(back.ranges, log.ranges);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back.scans[i].time, log.scans[i].time);
    EXPECT_EQ(back.scans[i].odom_from_robot.x, log.scans[i].odom_from_robot.x);
    const PlanarPose& a = back.GeometryOf(back.scans[i]).robot_from_laser;
    const PlanarPose& b = log.GeometryOf(log.scans[i]).robot_from_laser;
    EXPECT_NEAR(a.x, b.x, 1e-12);
    EXPECT_NEAR(a.yaw, b.yaw, 1e-12);
  }
}

// Cut at a line's end it is a shorter log, and nobody can tell.
TEST(Carmen, RefusesALineThatWasCut) {
  const std::string text = Flaser(5);
  for (std::size_t n = 0; n < text.rfind("0.5"); ++n)
    EXPECT_THROW(Read(text.substr(0, n)), Error) << n << " bytes";
}

TEST(Relations, AreReadAndRefused) {
  const auto relations = ParseRelations("# t t\n1.5 2.5 0.1 0.2 0 0 0 0.3\n", "a.relations");
  ASSERT_EQ(relations.size(), 1u);
  EXPECT_EQ(relations[0].time_b, 2.5);
  EXPECT_EQ(relations[0].a_from_b.yaw, 0.3);
  EXPECT_EQ(MessageOf([] { ParseRelations("1 2 0.1 0.2 0 0 0\n", "a.relations"); }),
            "a.relations:1:18: expected a number (yaw), found the end of the line");
  EXPECT_THROW(ParseRelations("# nothing\n", "a.relations"), Error);
}

TEST(Carmen, ReadsTheRecordedLogsWhole) {
  const struct {
    const char* name;
    std::size_t scans;
  } logs[] = {{"fr079", 4934}, {"intel", 13631}, {"mit-csail", 1988}, {"mit-killian", 17480}};
  for (const auto& recorded : logs) {
    const std::string path =
        std::string(GRATICULE_DATA_DIR) + "/mapping/kuemmerle/" + recorded.name + ".clf.gz";
    std::string text;
    try {
      text = ReadFile(path);
    } catch (const Error&) {
      GTEST_SKIP() << path << " is not there";
    }
    LaserLog log;
    const CarmenSummary summary = ParseCarmen(text, path, {}, &log);
    EXPECT_EQ(summary.scans, recorded.scans) << recorded.name;
    EXPECT_EQ(summary.times, LogTimes::kMessage) << recorded.name;
    EXPECT_EQ(log.geometries.size(), 1u) << recorded.name;
  }
}

}  // namespace
}  // namespace graticule
