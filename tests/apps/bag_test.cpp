// ROS bags, written by ROS' own library: the same map and the same camera come out as of a CARMEN
// log and of pictures, and what is wrong is one clear error.

#include "bag_writer.hpp"

#include <cmath>

#include "command.hpp"
#include "graticule/io/bag.hpp"
#include "graticule/io/bag_laser.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::test {
namespace {

using rosbag::CompressionType;
using rosbag::compression::BZ2;
using rosbag::compression::LZ4;
using rosbag::compression::Uncompressed;

class BagTest : public CommandTest {
 protected:
  // A robot's first half minute in the simulated town.
  LaserLog Drive() {
    const Outcome made = RunCommand({"simulate", "mission", "--robots", "1", "--minutes", "0.5",
                                     "--pictures", "0", "-o", Path("mission"), "--quiet"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    LaserLog log;
    const std::string path = Path("mission/robot1.log");
    ParseCarmen(ReadFile(path), path, {}, &log);
    return log;
  }

  static void WriteMessage(rosbag::Bag* bag, const std::string& topic, double time,
                           const std::string& type, const RosBytes& bytes) {
    bag->write(topic, ros::Time(time + 1), RawMessage{type, bytes.Whole()});
  }

  static RosBytes Scan(const LaserLog& log, const LaserScan& scan, bool reversed = false) {
    const LaserGeometry& geometry = log.GeometryOf(scan);
    const auto first = static_cast<float>(geometry.first_angle);
    const auto step = static_cast<float>(geometry.step);
    RosBytes bytes;
    bytes.Header(kBegin + scan.time, "laser");
    bytes.Add(first).Add(-first).Add(step).Add(0.f).Add(0.f).Add(0.f);
    bytes.Add(static_cast<float>(geometry.max_range)).Add(scan.beams);
    for (std::uint32_t i = 0; i < scan.beams; ++i) {
      const float range = log.RangesOf(scan)[reversed ? scan.beams - 1 - i : i];
      const bool is_lost = range >= geometry.max_range;
      bytes.Add(is_lost ? std::numeric_limits<float>::infinity() : range);
    }
    return bytes.Add(std::uint32_t{0});
  }

  static RosBytes Odometry(double time, const PlanarPose& pose) {
    RosBytes bytes;
    bytes.Header(time, "odom").Text("base_link").Pose(pose.x, pose.y, pose.yaw);
    for (int i = 0; i < 36 + 6 + 36; ++i) bytes.Add(0.0);
    return bytes;
  }

  static RosBytes Transform(double time, const std::string& parent, const std::string& child,
                            const PlanarPose& pose, bool is_upside_down = false) {
    RosBytes bytes;
    bytes.Add(std::uint32_t{1}).Header(time, parent).Text(child);
    return bytes.Pose(pose.x, pose.y, pose.yaw, is_upside_down);
  }

  // The log as ROS records it; odometry comes five times a second.
  std::string WriteBag(const std::string& name, const LaserLog& log, CompressionType packed,
                       bool by_tf = false, bool upside_down = false) {
    rosbag::Bag bag(Path(name), rosbag::bagmode::Write);
    bag.setCompression(packed);
    bag.setChunkThreshold(20000);
    const PlanarPose& mounted = log.geometries[0].robot_from_laser;
    WriteMessage(&bag, "/tf_static", kBegin, "tf2_msgs/TFMessage",
                 Transform(kBegin, "base_link", "plate", {mounted.x, mounted.y, 0}));
    WriteMessage(&bag, "/tf_static", kBegin, "tf2_msgs/TFMessage",
                 Transform(kBegin, "plate", "laser", {0, 0, mounted.yaw}, upside_down));
    for (std::size_t i = 0; i < log.scans.size(); ++i) {
      const double time = kBegin + log.scans[i].time;
      WriteMessage(&bag, "/scan", time, "sensor_msgs/LaserScan",
                   Scan(log, log.scans[i], upside_down));
      for (int k = 0; k < (i + 1 < log.scans.size() ? 5 : 1); ++k) {
        PlanarPose pose = log.scans[i].odom_from_robot;
        if (k > 0) pose = Interpolated(pose, log.scans[i + 1].odom_from_robot, 0.2 * k);
        if (by_tf)
          WriteMessage(&bag, "/tf", time + 0.2 * k, "tf2_msgs/TFMessage",
                       Transform(time + 0.2 * k, "/odom", "base_link", pose));
        else
          WriteMessage(&bag, "/odom", time + 0.2 * k, "nav_msgs/Odometry",
                       Odometry(time + 0.2 * k, pose));
      }
    }
    bag.close();
    return Path(name);
  }

  static std::string Why(const std::string& path) {
    try {
      BagTopics(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  static constexpr double kBegin = 1600000000;
};

TEST_F(BagTest, GivesTheScansAndTheOdometryOfTheLog) {
  const LaserLog log = Drive();
  int number = 0;
  for (const CompressionType packed : {Uncompressed, BZ2, LZ4})
    for (const bool by_tf : {false, true})
      for (const bool upside_down : {false, true}) {
        const std::string path =
            WriteBag(std::to_string(number++) + ".bag", log, packed, by_tf, upside_down);
        LaserLog read;
        const BagLaserSummary summary = ReadBagLaser(path, {}, &read);
        EXPECT_EQ(summary.scan_topic, "/scan");
        EXPECT_EQ(summary.odometry, by_tf ? "tf odom -> base_link" : "/odom");
        EXPECT_EQ(summary.without_odometry, 0u);
        ASSERT_EQ(read.scans.size(), log.scans.size());
        EXPECT_EQ(read.robots, log.robots);
        EXPECT_EQ(read.ranges, log.ranges);
        ASSERT_EQ(read.geometries.size(), 1u);
        const LaserGeometry &a = log.geometries[0], &b = read.geometries[0];
        EXPECT_NEAR(a.first_angle, b.first_angle, 1e-6);
        EXPECT_NEAR(a.step, b.step, 1e-8);
        EXPECT_NEAR(a.max_range, b.max_range, 1e-6);
        EXPECT_NEAR(a.robot_from_laser.x, b.robot_from_laser.x, 1e-12);
        EXPECT_NEAR(a.robot_from_laser.yaw, b.robot_from_laser.yaw, 1e-12);
        for (std::size_t i = 0; i < log.scans.size(); ++i) {
          EXPECT_NEAR(read.scans[i].time, kBegin + log.scans[i].time, 1e-6);
          const PlanarPose off =
              Inverse(log.scans[i].odom_from_robot) * read.scans[i].odom_from_robot;
          EXPECT_LT(std::hypot(off.x, off.y, off.yaw), 1e-6) << i;
        }
      }
}

TEST_F(BagTest, MakesTheMapOfTheLog) {
  const LaserLog log = Drive();
  const std::string bag = WriteBag("robot.bag", log, LZ4);
  const auto map = [&](const std::string& from, const std::string& folder) {
    const Outcome outcome = RunCommand({"map", from, "-o", Path(folder), "--quiet"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_NE(map(bag, "of_bag").find("31 scans of /scan, odometry of /odom"), std::string::npos);
  // As a log with the digits that a bag holds: angles are of single precision there, and a search
  // among cells may end in another one for less.
  LaserLog read;
  ReadBagLaser(bag, {}, &read);
  map(Write("robot.log", FormatCarmen(read, 0)), "of_log");
  EXPECT_TRUE(ReadWhole(Path("of_log/map.pgm")) == ReadWhole(Path("of_bag/map.pgm")));
}

TEST_F(BagTest, SaysWhatItHasWhereATopicIsMissing) {
  const LaserLog log = Drive();
  const std::string bag = WriteBag("robot.bag", log, Uncompressed);
  const auto refusal = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"map", bag, "-o", Path("out")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
    return outcome.err;
  };
  const std::string wrong = refusal({"--scan-topic", "/base_scan"});
  for (const char* part : {"/base_scan", "/scan (sensor_msgs/LaserScan)",
                           "/odom (nav_msgs/Odometry)", "/tf_static (tf2_msgs/TFMessage)"})
    EXPECT_NE(wrong.find(part), std::string::npos) << wrong;
  EXPECT_NE(refusal({"--odom-topic", "/scan"}).find("no topic /scan of type nav_msgs/Odometry"),
            std::string::npos);
  const Outcome images = RunCommand({"calibrate", bag, "-o", Path("camera.yaml")});
  EXPECT_EQ(images.exit_code, 3);
  EXPECT_NE(images.err.find("has no images"), std::string::npos) << images.err;
}

TEST_F(BagTest, RefusesWhatIsCutShortOrDamagedOrNoBag) {
  LaserLog log = Drive();
  log.scans.resize(3);
  for (const CompressionType packed : {Uncompressed, BZ2, LZ4}) {
    const std::string whole = ReadWhole(WriteBag("whole.bag", log, packed));
    EXPECT_EQ(Why(Path("whole.bag")), "");
    for (std::size_t size = 0; size < whole.size(); size += size < 5000 ? 1 : 97)
      EXPECT_THROW(
          {
            BagReader reader = BagReader::OfContents(whole.substr(0, size), "cut.bag");
            BagMessage message;
            while (reader.Next(&message)) {
            }
          },
          Error)
          << size;
    // Any byte may be wrong: refused, or read as something else, and nothing worse.
    for (std::size_t at = 13; at < whole.size(); at += 11) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
      try {
        BagReader reader = BagReader::OfContents(damaged, "damaged.bag");
        BagMessage message;
        while (reader.Next(&message)) {
        }
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find("damaged.bag: "), 0u) << error.what();
      }
    }
  }
  std::string open = ReadWhole(Path("whole.bag"));
  const std::size_t index = open.find("index_pos=");
  ASSERT_NE(index, std::string::npos);
  open.replace(index + 10, 8, 8, '\0');
  EXPECT_NE(Why(Write("open.bag", open)).find("rosbag reindex"), std::string::npos);
  EXPECT_NE(Why(Write("old.bag", "#ROSBAG V1.2\n")).find("older version"), std::string::npos);
  EXPECT_NE(Why(Write("no.bag", "SQLite format 3")).find("no ROS bag"), std::string::npos);
  EXPECT_NE(Why(Path("none.bag")).find("No such file"), std::string::npos);
}

TEST_F(BagTest, RefusesAMessageThatIsNotWhatItsTypeSays) {
  {
    rosbag::Bag bag(Path("short.bag"), rosbag::bagmode::Write);
    WriteMessage(&bag, "/scan", kBegin, "sensor_msgs/LaserScan",
                 RosBytes().Header(kBegin, "laser"));
    WriteMessage(&bag, "/odom", kBegin, "nav_msgs/Odometry", Odometry(kBegin, {}));
  }
  const Outcome outcome = RunCommand({"map", Path("short.bag"), "-o", Path("out")});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("/scan: a sensor_msgs/LaserScan that is cut short"), std::string::npos)
      << outcome.err;
}

// Whole pictures, and packed ones as cameras' drivers send them.
TEST_F(BagTest, CalibratesTheCameraOfThePictures) {
  ASSERT_EQ(RunCommand({"simulate", "mission", "--robots", "1", "--minutes", "0.1", "--pictures",
                        "6", "-o", Path("mission"), "--quiet"})
                .exit_code,
            0);
  {
    rosbag::Bag bag(Path("run.bag"), rosbag::bagmode::Write);
    bag.setCompression(BZ2);
    for (int i = 0; i < 6; ++i) {
      const std::string png =
          ReadWhole(Path("mission/cameras/robot1/0" + std::to_string(i) + ".png"));
      RosBytes bytes;
      bytes.Header(kBegin + i, "camera").Text("png").Text(png);
      WriteMessage(&bag, "/camera/image_raw/compressed", kBegin + i, "sensor_msgs/CompressedImage",
                   bytes);
      RosBytes grey;
      grey.Header(kBegin + i, "other").Add(std::uint32_t{2}).Add(std::uint32_t{3});
      grey.Text("mono8").Add(std::uint8_t{0}).Add(std::uint32_t{3}).Text("123456");
      WriteMessage(&bag, "/other/image_raw", kBegin + i, "sensor_msgs/Image", grey);
    }
  }
  const std::string target = Path("mission/cameras/target.yaml");
  const auto calibrate = [&](const std::string& source, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"calibrate", source,   "--target",
                                      target,      "--json", "--model",
                                      "angular2",  "-o",     Path("camera.yaml")};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words);
  };
  const Outcome several = calibrate(Path("run.bag"), {});
  EXPECT_EQ(several.exit_code, 3);
  EXPECT_NE(several.err.find("say which (--image-topic)"), std::string::npos) << several.err;
  const Outcome of_bag =
      calibrate(Path("run.bag"), {"--image-topic", "/camera/image_raw/compressed"});
  ASSERT_EQ(of_bag.exit_code, 0) << of_bag.err;
  const std::string camera = ReadWhole(Path("camera.yaml"));
  ASSERT_EQ(calibrate(Path("mission/cameras/robot1"), {}).exit_code, 0);
  const auto parameters = [](const std::string& file) {
    const std::size_t at = file.find("parameters:");
    return file.substr(at, file.find('\n', at) - at);
  };
  EXPECT_EQ(parameters(camera), parameters(ReadWhole(Path("camera.yaml"))));
  const Outcome small = calibrate(Path("run.bag"), {"--image-topic", "/other/image_raw"});
  EXPECT_EQ(small.exit_code, 3) << small.err;
}

}  // namespace
}  // namespace graticule::test
