#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.hpp"

namespace graticule::test {
namespace {

const char* const kCamera =
    "graticule-camera: 1\ncameras:\n  - name: \"front\"\n    model: pinhole\n    size: [640, 480]\n"
    "    parameters: [500, 500, 320, 240]\n    camera_from_rig: [0, 0, 0, 0, 0, 0, 1]\nend: 1\n";

struct Row {
  double x, y, z, u, v;
};

std::string Text(const std::vector<Row>& rows) {
  std::ostringstream text;
  text.precision(12);
  for (const Row& r : rows)
    text << r.x << ',' << r.y << ',' << r.z << ',' << r.u << ',' << r.v << '\n';
  return text.str();
}

// A camera that looks along the LIDAR's x from (-0.05, 0.1, 0.2) in its frame; pixels are half a
// pixel off, and two belong to other points.
std::vector<Row> Rows() {
  std::vector<Row> rows;
  for (int i = 0; i < 24; ++i) {
    const double x = 2 + 0.8 * (i * 7 % 11);
    const double y = x * 0.5 * ((i * 5 % 13 - 6) / 6.0);
    const double z = x * 0.35 * ((i * 3 % 7 - 3) / 3.0);
    const double depth = x + 0.05;
    rows.push_back({x, y, z, 320 - 500 * (y - 0.1) / depth + 0.5 * ((i * 37 % 19 - 9) / 9.0),
                    240 - 500 * (z - 0.2) / depth + 0.5 * ((i * 11 % 17 - 8) / 8.0)});
  }
  rows[4].u += 60;
  rows[11].v -= 35;
  return rows;
}

class CoregisterCommand : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    camera_ = Write("camera.yaml", kCamera);
    points_ = Write("points.csv", Text(Rows()));
  }

  Outcome Coregister(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"coregister", "--camera",      camera_, "--points",
                                      points_,      "--lidar-sigma", "0.001"};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words);
  }

  std::string camera_, points_;
};

TEST_F(CoregisterCommand, FindsTheCameraAndNamesWhatIsWrong) {
  const Outcome outcome = Coregister({"-o", Path("rig.yaml"), "--record", Path("rig.fg"), "--plot",
                                      Path("plot.svg"), "--error-map", Path("map.png"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json json = JsonOf(outcome);
  EXPECT_EQ(json["outliers"], nlohmann::json({"5", "12"}));
  // R (p - c) with c = (-0.05, 0.1, 0.2): t = (0.1, 0.2, 0.05).
  EXPECT_NEAR(json["camera_from_lidar"][0].get<double>(), 0.1, 0.01);
  EXPECT_NEAR(json["camera_from_lidar"][1].get<double>(), 0.2, 0.01);
  EXPECT_NEAR(json["camera_from_lidar"][2].get<double>(), 0.05, 0.02);
  EXPECT_LT(json["held_out"]["rms_counted_px"], 1);
  EXPECT_EQ(json["expected_error"].size(), 3u);
  EXPECT_LT(json["next"]["max_px"], json["next"]["max_px_before"]);
  EXPECT_EQ(json["residuals"].size(), 24u);
  EXPECT_NE(ReadWhole(Path("plot.svg")).find("<svg"), std::string::npos);
  EXPECT_EQ(ReadWhole(Path("map.png")).substr(1, 3), "PNG");

  // The graph is at its minimum, and its residuals are as large as it says.
  const Outcome solved = RunCommand({"solve", Path("rig.fg"), "--json"});
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  const nlohmann::json report = JsonOf(solved);
  EXPECT_NEAR(report["final_cost"].get<double>() / report["initial_cost"].get<double>(), 1, 1e-6);
  EXPECT_EQ(RunCommand({"inspect", Path("rig.fg")}).exit_code, 0);

  // The same, as it is printed.
  const Outcome printed = Coregister({});
  EXPECT_NE(printed.out.find("outliers            5 (60 px), 12 (35 px)"), std::string::npos)
      << printed.out;
  EXPECT_EQ(Coregister({"--json"}).out, outcome.out);
}

TEST_F(CoregisterCommand, FreesOfTheCameraWhatHelps) {
  // The horizontal focal length is 8 % off.
  camera_ = Write("long.yaml", std::string(kCamera).replace(std::string(kCamera).find("[500, 500"),
                                                            9, "[540, 500"));
  const nlohmann::json held = JsonOf(Coregister({"--json"}));
  const nlohmann::json freed = JsonOf(Coregister({"--free", "--json"}));
  EXPECT_LT(freed["held_out"]["rms_counted_px"], held["held_out"]["rms_counted_px"]);
  EXPECT_TRUE(freed["freed"][0]["kept"].get<bool>());
  EXPECT_NEAR(freed["camera"]["parameters"][0].get<double>(), 500, 5);
}

TEST_F(CoregisterCommand, ItsRigColoursAScan) {
  const std::string kitti = GRATICULE_DATA_DIR "/segment/kitti3/";
  if (!std::filesystem::is_directory(kitti)) GTEST_SKIP() << "no recorded clouds: " << kitti;
  // Frame 000001: P2 and R0 Tr of its calibration, to 1e-4, with points of a grid.
  std::ifstream in(kitti + "calib/000001.txt");
  double p2[12], r0[9], tr[12];
  for (std::string word; in >> word;) {
    double* const to = word == "P2:" ? p2 : word == "R0_rect:" ? r0 : tr;
    const int count = word == "R0_rect:" ? 9 : 12;
    if (word == "P2:" || word == "R0_rect:" || word == "Tr_velo_to_cam:")
      for (int i = 0; i < count; ++i) in >> to[i];
  }
  std::vector<Row> rows;
  for (int i = 0; i < 20; ++i) {
    const double x = 5 + 1.7 * (i * 7 % 11), y = x * 0.1 * (i * 5 % 13 - 6),
                 z = x * 0.03 * (i * 3 % 7 - 4);
    double a[3], b[3], c[3];
    for (int k = 0; k < 3; ++k)
      a[k] = tr[4 * k] * x + tr[4 * k + 1] * y + tr[4 * k + 2] * z + tr[4 * k + 3];
    for (int k = 0; k < 3; ++k)
      b[k] = r0[3 * k] * a[0] + r0[3 * k + 1] * a[1] + r0[3 * k + 2] * a[2];
    for (int k = 0; k < 3; ++k)
      c[k] = p2[4 * k] * b[0] + p2[4 * k + 1] * b[1] + p2[4 * k + 2] * b[2] + p2[4 * k + 3];
    rows.push_back({x, y, z, c[0] / c[2], c[1] / c[2]});
  }
  std::ostringstream camera;
  camera.precision(12);
  camera
      << "graticule-camera: 1\ncameras:\n  - name: \"cam2\"\n    model: pinhole\n    size: [1242, "
         "375]\n    parameters: ["
      << p2[0] << ", " << p2[5] << ", " << p2[2] << ", " << p2[6]
      << "]\n    camera_from_rig: [0, 0, 0, 0, 0, 0, 1]\nend: 1\n";
  camera_ = Write("cam2.yaml", camera.str());
  points_ = Write("kitti.csv", Text(rows));
  const Outcome found = Coregister({"-o", Path("rig.yaml")});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const std::vector<std::string> segment = {"segment", kitti + "velodyne/000001.bin",
                                            "--image", kitti + "image_2/000001.png",
                                            "--json",  "--rig"};
  std::vector<std::string> ours = segment, theirs = segment;
  ours.push_back(Path("rig.yaml"));
  theirs.push_back(kitti + "calib/000001.txt");
  const nlohmann::json a = JsonOf(RunCommand(ours)), b = JsonOf(RunCommand(theirs));
  EXPECT_NEAR(a["colours"]["seen"].get<double>(), b["colours"]["seen"].get<double>(), 20);
}

TEST_F(CoregisterCommand, RefusesWhatHasNoAnswer) {
  const std::vector<Row> rows = Rows();
  std::vector<Row> mirrored = rows, line, shuffled = rows;
  for (Row& row : mirrored) row.y *= -1;
  for (int i = 0; i < 10; ++i)
    line.push_back({2 + 0.1 * i, 0.1 * i, 0.05 * i, 100. + 20 * i, 200. + 10 * i});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    shuffled[i].u = rows[(i * 5 + 3) % rows.size()].u;
    shuffled[i].v = rows[(i * 5 + 3) % rows.size()].v;
  }
  const std::string text = Text(rows);
  const struct {
    std::string name, contents;
    int exit_code;
    std::string message;
  } cases[] = {
      {"few.csv", Text({rows.begin(), rows.begin() + 3}), 5, "at least 4 correspondences"},
      {"line.csv", Text(line), 5, "lie on a line"},
      {"mirrored.csv", Text(mirrored), 5, "mirror image only"},
      {"shuffled.csv", Text(shuffled), 5, "no pose of the camera explains half"},
      {"nan.csv", text + "nan,1,2,3,4\n", 3, "nan.csv:25:1: expected a finite number"},
      {"far.csv", "1e300,1,2,3,4\n", 3,
       "far.csv:1:1: expected x of the point within 1e6, found '1e300'"},
      {"cut.csv", text.substr(0, text.size() - 1), 3, "cut short"},
      {"empty.csv", "", 3, "empty"},
  };
  for (const auto& c : cases) {
    points_ = Write(c.name, c.contents);
    const Outcome outcome = Coregister({"-o", Path("rig.yaml")});
    EXPECT_EQ(outcome.exit_code, c.exit_code) << c.name;
    EXPECT_NE(outcome.err.find(c.message), std::string::npos) << outcome.err;
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(Path("rig.yaml")));
  }
  points_ = Path("none.csv");
  EXPECT_EQ(Coregister({}).exit_code, 3);
}

TEST_F(CoregisterCommand, AnOutputThatCannotBeWrittenCostsNoOther) {
  for (const char* option : {"--record", "--plot", "--error-map"}) {
    const std::string name = option == std::string("--record") ? "out.fg" : "out.svg";
    EXPECT_EQ(Coregister({option, Path("none/" + name), "-o", Path("rig.yaml")}).exit_code, 1);
    EXPECT_FALSE(std::filesystem::exists(Path("rig.yaml"))) << option << " is looked at too late";
  }
  std::filesystem::create_symlink("/dev/full", Path("full.svg"));
  const Outcome outcome = Coregister({"--plot", Path("full.svg"), "--error-map", Path("map.svg"),
                                      "-o", Path("rig.yaml"), "--json"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_TRUE(JsonOf(outcome).is_object());
  EXPECT_TRUE(std::filesystem::exists(Path("rig.yaml")));
  EXPECT_TRUE(std::filesystem::exists(Path("map.svg")));
}

TEST_F(CoregisterCommand, RefusesCamerasAndWordsThatDoNotFit) {
  EXPECT_EQ(Coregister({"--sigma", "nan"}).exit_code, 2);
  EXPECT_EQ(Coregister({"--range", "inf"}).exit_code, 2);
  EXPECT_EQ(Coregister({"--planes", points_}).exit_code, 2);
  EXPECT_EQ(Coregister({"--plot", Path("a.gif")}).exit_code, 2);
  std::string text = kCamera;
  camera_ =
      Write("sizeless.yaml", text.erase(text.find("    size"), sizeof("    size: [640, 480]")));
  const Outcome outcome = Coregister({});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("sizeless.yaml:"), std::string::npos) << outcome.err;
  EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
}

}  // namespace
}  // namespace graticule::test
