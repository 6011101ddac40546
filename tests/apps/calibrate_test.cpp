#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "command.hpp"

namespace graticule::test {
namespace {

using nlohmann::json;

// A camera of 640 x 480, focal length 500, without distortion, before a board of 9 x 6 corners:
// turned by `tilt` (for half of the views about x, for half about y), here and there.
json Board(int views, double tilt, double noise_px) {
  json set = {{"name", "cam"}, {"size", {640, 480}}, {"views", json::array()}};
  unsigned state = 12345;
  const auto random = [&] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / 16777216.0 * 2 - 1;
  };
  for (int v = 0; v < views; ++v) {
    json view = {{"name", "view" + std::to_string(v) + ".png"}};
    const double a = tilt * (v % 4 < 2 ? 1 : -1), c = std::cos(a), s = std::sin(a);
    const double x0 = .05 * (v % 3 - 1), y0 = .04 * (v % 5 - 2) / 2, z0 = .32 + .03 * (v % 4);
    for (int i = 0; i < 54; ++i) {
      const double x = .025 * (i % 9 - 4), y = .025 * (i / 9 - 2.5);
      const double X = (v % 2 ? c * x : x) + x0, Y = (v % 2 ? y : c * y) + y0;
      const double Z = (v % 2 ? -s * x : s * y) + z0;
      view["ids"].push_back(i);
      view["obj"].push_back({x, y, 0});
      view["img"].push_back(
          {320 + 500 * X / Z + noise_px * random(), 240 + 500 * Y / Z + noise_px * random()});
    }
    set["views"].push_back(view);
  }
  return set;
}

class Calibrate : public CommandTest {
 protected:
  Outcome Run(const json& detections, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"calibrate", Write("set.json", detections.dump()), "--quiet"});
    return RunCommand(more);
  }
};

TEST_F(Calibrate, FindsTheCameraAndWritesIt) {
  const Outcome outcome =
      Run(Board(12, .6, .1), {"-o", Path("camera.yaml"), "-o", "ros:" + Path("ros.yaml"),
                              "--record", Path("problem.fg"), "--report", Path("report.html"),
                              "--model", "pinhole", "--board", "flat", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json said = json::parse(outcome.out);
  EXPECT_NE(ReadWhole(Path("camera.yaml")).find("model: pinhole"), std::string::npos);
  EXPECT_NE(ReadWhole(Path("ros.yaml")).find("plumb_bob"), std::string::npos);
  EXPECT_NE(ReadWhole(Path("report.html")).find("<svg"), std::string::npos);
  // The record is the question with its answer: solving it again changes nothing.
  const Outcome solved = RunCommand({"solve", Path("problem.fg"), "--json"});
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  const json report = json::parse(solved.out);
  EXPECT_NEAR(report["final_cost"].get<double>(), report["initial_cost"].get<double>(),
              1e-6 * report["initial_cost"].get<double>());
  const Outcome test = RunCommand({"calibrate", "evaluate", Path("camera.yaml"), Path("set.json"),
                                   "--against", Path("ros.yaml"), "--json"});
  ASSERT_EQ(test.exit_code, 0) << test.err;
  const json evaluated = json::parse(test.out);
  EXPECT_LT(evaluated["test"]["rms_px"].get<double>(), .1);
  EXPECT_LT(evaluated["differences"][0]["max_px"].get<double>(), 1e-6);
}

TEST_F(Calibrate, SaysTheSameTwice) {
  const Outcome first = Run(Board(8, .5, .1), {"-o", Path("a.yaml")});
  const Outcome second = Run(Board(8, .5, .1), {"-o", Path("b.yaml")});
  EXPECT_EQ(first.out, second.out);
  EXPECT_EQ(ReadWhole(Path("a.yaml")), ReadWhole(Path("b.yaml")));
}

TEST_F(Calibrate, SaysWhatFlatViewsDoNotTell) {
  const Outcome outcome = Run(Board(10, 0, .1));
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_NE(outcome.out.find("do not constrain fx"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("Tilt the target"), std::string::npos) << outcome.out;
}

TEST_F(Calibrate, IsNotContentWithOneOrTwoViews) {
  for (const int views : {1, 2}) {
    const Outcome outcome = Run(Board(views, .5, .1));
    EXPECT_EQ(outcome.out.find("within the 1 px asked for"), std::string::npos) << outcome.out;
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 5) << outcome.exit_code;
  }
}

TEST_F(Calibrate, IsNotContentWithOneViewTakenTenTimes) {
  json set = Board(1, .5, .1);
  for (int i = 0; i < 9; ++i) {
    set["views"].push_back(set["views"][0]);
    set["views"].back()["name"] = "again" + std::to_string(i);
  }
  const Outcome outcome = Run(set);
  EXPECT_EQ(outcome.out.find("within the 1 px asked for"), std::string::npos) << outcome.out;
}

TEST_F(Calibrate, RefusesCornersThatNoCameraExplains) {
  json set = Board(6, .5, .1);
  for (json& view : set["views"]) std::reverse(view["img"].begin() + 7, view["img"].end() - 11);
  const Outcome outcome = Run(set);
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_NE((outcome.err + outcome.out).find("belong to it"), std::string::npos) << outcome.err;
}

TEST_F(Calibrate, RefusesWordsThatDoNotFit) {
  EXPECT_EQ(RunCommand({"calibrate"}).exit_code, 2);
  EXPECT_EQ(RunCommand({"calibrate", Path("none.json")}).exit_code, 3);
  EXPECT_EQ(Run(Board(4, .5, .1), {"--model", "angular44"}).exit_code, 2);
  EXPECT_EQ(Run(Board(4, .5, .1), {"-o", "rso:" + Path("a.yaml")}).exit_code, 2);
  EXPECT_EQ(Run(Board(4, .5, .1), {"--report", Path("a.txt")}).exit_code, 2);
  EXPECT_EQ(Files(), std::vector<std::string>{"set.json"});
}

TEST_F(Calibrate, LooksBeforeTheSolveWhetherEveryOutputCanBeWritten) {
  for (const char* option : {"--report", "--record", "--detections", "--pictures"}) {
    const std::string ending = option == std::string("--report") ? ".html" : ".fg";
    // Not a folder, so that nothing can be in it.
    const std::string nowhere = Write("file", "") + "/out" + ending;
    const Outcome outcome = Run(Board(4, .5, .1), {option, nowhere, "-o", Path("camera.yaml")});
    EXPECT_EQ(outcome.exit_code, 1) << option << outcome.err;
    EXPECT_EQ(Files(), (std::vector<std::string>{"file", "set.json"})) << option;
  }
}

TEST_F(Calibrate, AnOutputThatCannotBeWrittenCostsNoOther) {
  std::filesystem::create_symlink("/dev/full", Path("report.html"));
  std::filesystem::create_symlink("/dev/full", Path("corners.json"));
  const Outcome outcome =
      Run(Board(8, .5, .1), {"--report", Path("report.html"), "--detections", Path("corners.json"),
                             "-o", Path("camera.yaml"), "--model", "pinhole", "--json"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_EQ(CountLines(outcome.err), 2u) << outcome.err;
  EXPECT_EQ(JsonOf(outcome)["cameras"].size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(Path("camera.yaml")));
}

class CalibrateRecordedImages : public CommandTest {
 protected:
  static std::string Path(const std::string& file) {
    return GRATICULE_DATA_DIR "/calib/opencv_samples/" + file;
  }
  void SetUp() override {
    CommandTest::SetUp();
    if (std::filesystem::exists(Path("images/left01.jpg"))) return;
    const std::string missing = "no recorded images: " + Path("images");
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << missing;
    GTEST_SKIP() << missing;
  }
};

// The folder holds left01.jpg to left14.jpg and right01.jpg to right14.jpg.
TEST_F(CalibrateRecordedImages, OfTwoCamerasGiveARig) {
  const std::string target = Write("target.yaml",
                                   "graticule-target: 1\nkind: chessboard\ncolumns: 9\n"
                                   "rows: 6\npitch_m: 0.025\nend: target\n");
  const auto calibrate = [](std::vector<std::string> words) {
    words.insert(words.begin(), "calibrate");
    words.insert(words.end(), {"--model", "brown5", "--board", "flat", "--json"});
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out);
  };
  const json found = calibrate({Path("images"), "--target", target});
  const json recorded =
      calibrate({Path("detections/opencv_left.json"), Path("detections/opencv_right.json")});
  ASSERT_EQ(found["cameras"].size(), 2u);
  EXPECT_EQ(found["cameras"][0]["name"], "left");
  EXPECT_EQ(found["cameras"][1]["name"], "right");
  EXPECT_NE(found["warnings"].dump().find("several cameras: left, right"), std::string::npos);
  // OpenCV's detector found the recorded corners, 0.07 px from ours.
  const auto baseline = [](const json& report) {
    for (const json& number : report["cameras"][1]["parameters"])
      if (number["name"] == "camera_from_rig x") return number["value"].get<double>();
    return 0.;
  };
  EXPECT_NEAR(baseline(found), -.0833, 3e-4);
  EXPECT_NEAR(baseline(found), baseline(recorded), 1e-4);
}

// The lens has one term: a little worse than radial2's two, far better than none.
TEST_F(CalibrateRecordedImages, AreExplainedByALensFromAPlugin) {
  const std::string corners = Path("detections/opencv_left.json");
  const std::string camera = CommandTest::Path("camera.yaml");
  const std::string record = CommandTest::Path("problem.fg");
  const auto rms = [&](const std::string& model, std::vector<std::string> more) {
    std::vector<std::string> words = {"calibrate", corners,    "--model",
                                      model,       "--board",  "flat",
                                      "--json",    "--plugin", GRATICULE_LENS_PLUGIN};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out)["cameras"][0]["rms_px"].get<double>();
  };
  const double division = rms("division", {"-o", camera, "--record", record});
  EXPECT_LT(division, 1.1 * rms("radial2", {}));
  EXPECT_LT(division, .5 * rms("pinhole", {}));

  const Outcome checked = RunCommand({"check", record, "--plugin", GRATICULE_LENS_PLUGIN});
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  const Outcome tested = RunCommand(
      {"calibrate", "evaluate", camera, corners, "--plugin", GRATICULE_LENS_PLUGIN, "--json"});
  ASSERT_EQ(tested.exit_code, 0) << tested.err;
  EXPECT_NEAR(json::parse(tested.out)["test"]["rms_px"].get<double>(), division, 1e-3);
  const Outcome unknown = RunCommand({"calibrate", "evaluate", camera, corners});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("no camera model 'division'"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace graticule::test
