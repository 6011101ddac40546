#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace graticule::test {
namespace {

const std::string kClouds = GRATICULE_DATA_DIR "/segment/";

class Segment : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    if (std::filesystem::is_directory(kClouds)) return;
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << "no recorded clouds: " << kClouds;
    GTEST_SKIP() << "no recorded clouds: " << kClouds;
  }
};

TEST_F(Segment, PartsATableSceneAndWritesIt) {
  const std::string cloud = kClouds + "mosd/test/test0.pcd";
  const Outcome outcome =
      RunCommand({"segment", cloud, "-o", Path("labels.ply"), "--picture", Path("scene.png"),
                  "--label-image", Path("labels.png"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["grid"], nlohmann::json({640, 480}));
  EXPECT_EQ(json["segments"].size(), 3u);  // the table and two objects
  std::size_t points = 0;
  for (const auto& segment : json["segments"]) points += segment["points"].get<std::size_t>();
  EXPECT_EQ(points, json["points"]);
  EXPECT_GT(std::filesystem::file_size(Path("scene.png")), 10000u);
  EXPECT_GT(std::filesystem::file_size(Path("labels.png")), 1000u);

  // What was written is a cloud again, and says the same in every method.
  const Outcome again = RunCommand({"segment", Path("labels.ply"), "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out)["segments"].size(), 3u);
  for (const char* method : {"joint", "colour", "normals", "image"})
    EXPECT_EQ(RunCommand({"segment", cloud, "--method", method, "--quiet"}).exit_code, 0);
}

TEST_F(Segment, ColoursALidarsScanByAPicture) {
  const std::string frame = kClouds + "kitti3/";
  const Outcome outcome =
      RunCommand({"segment", frame + "velodyne/000001.bin", "--image", frame + "image_2/000001.png",
                  "--rig", frame + "calib/000001.txt", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_GT(json["colours"]["seen"], 10000);
  EXPECT_GT(json["colours"]["hidden"], 100);
  EXPECT_LT(json["points"], json["colours"]["seen"].get<std::size_t>() + 1);
  EXPECT_TRUE(json["segments"][0].contains("mean_colour"));

  const Outcome other =
      RunCommand({"segment", frame + "velodyne/000001.bin", "--image",
                  kClouds + "kitti3/image_2/000001.png", "--rig", Write("rig.yaml", "a: 1\n")});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_EQ(CountLines(other.err), 1u) << other.err;
}

TEST_F(CommandTest, SegmentsASimulatedScene) {
  ASSERT_EQ(RunCommand({"simulate", "scene", "hallway", "-o", Path("hallway")}).exit_code, 0);
  const std::string folder = Path("hallway/");
  for (const char* method : {"joint", "convex"}) {
    const Outcome outcome =
        RunCommand({"segment", folder + "scan.pcd", "--image", folder + "image.png", "--rig",
                    folder + "rig.yaml", "--method", method, "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_GT(nlohmann::json::parse(outcome.out)["segments"].size(), 8u);
  }
  EXPECT_EQ(RunCommand({"simulate", "scene", "attic", "-o", Path("a")}).exit_code, 2);
}

TEST_F(Segment, SweepsParametersAgainstLabels) {
  const std::string scan = kClouds + "mosd/learn/learn0.pcd";
  const Outcome outcome =
      RunCommand({"segment", "evaluate", scan, "--methods", "convex", "joint", "--sweep",
                  "k-rgb=20000,200", "--sweep", "k-norm=20", "--least-object", "20", "--plot",
                  Path("sweep.svg"), "--report", Path("sweep.html"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  const auto& rows = json["rows"];
  ASSERT_EQ(rows.size(), 3u);  // convex has neither parameter
  EXPECT_FALSE(rows[0].contains("parameters"));
  EXPECT_EQ(rows[1]["parameters"], nlohmann::json({{"k-rgb", 200}, {"k-norm", 20}}));
  EXPECT_EQ(rows[2]["parameters"]["k-rgb"], 20000);
  EXPECT_GT(rows[0]["mean_f"], 0.9);
  // A small threshold parts more.
  EXPECT_GT(rows[1]["segments"], 2 * rows[2]["segments"].get<double>());
  for (const auto& row : rows)
    for (const char* share : {"weighted_overlap", "achievable_accuracy", "boundary_recall"}) {
      EXPECT_GT(row[share], 0);
      EXPECT_LE(row[share], 1);
    }
  EXPECT_NE(ReadWhole(Path("sweep.svg")).find("under-segmentation error"), std::string::npos);
  EXPECT_NE(ReadWhole(Path("sweep.html")).find("learn0.pcd"), std::string::npos);

  // The truth of another file, which is this method's own answer.
  ASSERT_EQ(RunCommand({"segment", scan, "-o", Path("own.pcd"), "--quiet"}).exit_code, 0);
  const Outcome own = RunCommand(
      {"segment", "evaluate", scan, "--truth", Path("own.pcd"), "--methods", "convex", "--json"});
  ASSERT_EQ(own.exit_code, 0) << own.err;
  EXPECT_EQ(nlohmann::json::parse(own.out)["rows"][0]["weighted_overlap"], 1);
}

TEST_F(Segment, KnowsALidarThatTurnsByWhatWasReadNotByItsName) {
  const std::string scan = kClouds + "kitti3/velodyne/000001.bin";
  const std::string packed = Write("packed.bin.gz", ReadWhole(scan));  // unpacked by what is inside
  const auto segments = [&](const std::string& path) {
    const Outcome outcome = RunCommand({"segment", path, "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["segments"];
  };
  EXPECT_EQ(segments(packed), segments(scan));
}

TEST_F(Segment, WritesAPageOfItsSegments) {
  const Outcome outcome = RunCommand(
      {"segment", kClouds + "mosd/test/test0.pcd", "--report", Path("page.html"), "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = ReadWhole(Path("page.html"));
  for (const char* part : {"data:image/png;base64,", "640 x 480", "concave [degrees]", "#"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
}

TEST_F(Segment, AnOutputThatCannotBeWrittenCostsNoOther) {
  const std::string cloud = kClouds + "mosd/test/test0.pcd";
  const Outcome late =
      RunCommand({"segment", cloud, "--picture", Path("a.png"), "-o", Path("none/a.ply")});
  EXPECT_EQ(late.exit_code, 1) << late.err;
  EXPECT_TRUE(Files().empty());
  std::filesystem::create_symlink("/dev/full", Path("full.png"));
  const Outcome outcome = RunCommand(
      {"segment", cloud, "--picture", Path("full.png"), "-o", Path("labels.ply"), "--json"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_EQ(JsonOf(outcome)["segments"].size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(Path("labels.ply")));
}

TEST_F(Segment, RefusesWhatItCannotSegment) {
  const std::string flat =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\n"
      "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1 0 0\n1 1 0\n";
  const struct {
    std::vector<std::string> words;
    int exit_code;
    const char* message;
  } cases[] = {
      {{"segment", Write("flat.pcd", flat)}, 3, "flat.pcd: the cloud is not organised"},
      {{"segment", Path("none.pcd")}, 3, "none.pcd: No such file"},
      {{"segment", Write("cut.pcd", flat.substr(0, flat.size() - 4))}, 3, "cut.pcd:"},
      {{"segment", kClouds + "mosd/test/test0.pcd", "--image", "a.png"}, 2, "go together"},
      {{"segment"}, 2, "expected a cloud"},
      {{"segment", "evaluate", kClouds + "kitti3/velodyne/000001.bin"}, 3, "expected labels"},
      {{"segment", "evaluate", kClouds + "mosd/test/test0.pcd", "--sweep", "k-red=1"},
       2,
       "expected one of k-rgb"},
      {{"segment", "evaluate", kClouds + "mosd/test/test0.pcd", "--sweep", "min-size=1.5"},
       2,
       "not allowed for min-size"},
      {{"segment", "evaluate", kClouds + "mosd/test/test0.pcd", "--plot", "a.svg"}, 2, "--sweep"},
      {{"segment", "evaluate", kClouds + "mosd/test/test0.pcd", "--truth",
        kClouds + "kitti3/velodyne/000001.bin"},
       3,
       "points;"},
      {{"segment", kClouds + "mosd/test/test0.pcd", "-o", Path("a.obj")}, 2, ".ply"},
      {{"segment", kClouds + "kitti3/velodyne/000001.bin", "--method", "joint"}, 3, "no colours"},
      {{"segment", kClouds + "kitti3/velodyne/000001.bin", "--image",
        kClouds + "kitti3/image_2/000001.png", "--rig", Write("calib.txt", "P2: 1 2 3\n")},
       3,
       "calib.txt:1: P2: expected 12 numbers, found 3"},
  };
  for (const auto& c : cases) {
    const Outcome outcome = RunCommand(c.words);
    EXPECT_EQ(outcome.exit_code, c.exit_code) << outcome.err;
    EXPECT_NE(outcome.err.find(c.message), std::string::npos) << outcome.err;
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
  }
}

}  // namespace
}  // namespace graticule::test
