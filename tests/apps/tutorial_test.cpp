// docs/tutorial.md: its commands are run as they stand there, in order, and what comes out is held
// against the truth.  What the page says was measured with this mission; the bounds here leave half
// as much again.

#include <cstdlib>
#include <fstream>

#include "command.hpp"

namespace graticule::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsSlow = true;
#else
constexpr bool kIsSlow = false;
#endif

class Tutorial : public CommandTest {
 protected:
  // The script that run-demo runs, too.
  void RunPage() {
    const std::string source = GRATICULE_SOURCE_DIR;
    const std::string programs = fs::path(GRATICULE_PROGRAM).parent_path().string();
    const std::string script = Path("tutorial.sh"), log = Path("tutorial.log");
    // A mission of half a minute shows to a sanitizer what one of five does.
    const std::string shorten = kIsSlow ? " | sed 's/--minutes 5/--minutes 0.5/'" : "";
    const std::string command = "'" + source + "/.ci/tutorial.sh'" + shorten + " > '" + script +
                                "' && cd '" + folder_.string() + "' && PATH='" + programs +
                                "':\"$PATH\" bash -euo pipefail tutorial.sh > '" + log + "' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << ReadWhole(log);
    log_ = ReadWhole(log);
  }

  Json Answer(std::vector<std::string> words) const {
    RunOptions here;
    here.folder = folder_.string();
    words.emplace_back("--json");
    return JsonOf(RunCommand(words, here));
  }

  std::string log_;
};

TEST_F(Tutorial, LeadsNearToTheTruth) {
  ASSERT_NO_FATAL_FAILURE(RunPage());
  for (const char* name : {"robot1.yaml", "robot2.yaml", "robot3.yaml", "rig.yaml", "model.fg",
                           "things.ply", "strength.png", "attenuation.png", "difference.png",
                           "residuals.png", "things.png", "compare.html", "map/drawing.png"})
    EXPECT_GT(fs::file_size(Path(name)), 100u) << name;
  if (kIsSlow) return;

  const Json camera =
      Answer({"calibrate", "evaluate", "robot1.yaml", "mission/cameras/robot1", "--target",
              "mission/cameras/target.yaml", "--against", "mission/truth/robot1.yaml"});
  EXPECT_LT(camera["test"]["rms_px"], 0.16);
  EXPECT_LT(camera["differences"][0]["mean_px"], 0.24);

  const Json rig = Answer({"coregister", "--camera", "robot1.yaml", "--points",
                           "mission/scene/points.csv", "--against", "mission/truth/rig.yaml"});
  EXPECT_LT(rig["apart"]["m"], 0.014);
  EXPECT_LT(rig["apart"]["degrees"], 0.2);
  const Json truth = Json::parse(ReadWhole(Path("mission/truth/truth.json")));
  ASSERT_EQ(rig["outliers"].size(), truth["scene"]["wrong_points"].size());
  for (std::size_t i = 0; i < rig["outliers"].size(); ++i)
    EXPECT_EQ(rig["outliers"][i], std::to_string(truth["scene"]["wrong_points"][i].get<int>()));

  const Json map = Json::parse(ReadWhole(Path("map/report.json")));
  EXPECT_EQ(map["accuracy"]["together"]["matched"], map["accuracy"]["together"]["poses"]);
  EXPECT_LT(map["accuracy"]["together"]["ate"]["translation_m"]["mean"], 0.24);
  EXPECT_LT(map["accuracy"]["together"]["ate"]["rotation_deg"]["mean"], 0.45);

  // "mission/truth/links.csv: 400 strengths are predicted to 7.99 dB (rms; ...": MATTE, log-fit.
  std::vector<double> rms_db;
  const std::string before = "strengths are predicted to ";
  for (std::size_t at = log_.find(before); at != std::string::npos; at = log_.find(before, at + 1))
    rms_db.push_back(std::strtod(log_.c_str() + at + before.size(), nullptr));
  ASSERT_EQ(rms_db.size(), 2u) << log_;
  EXPECT_LT(rms_db[0], 9);
  EXPECT_LT(rms_db[0], rms_db[1]);

  const Json things =
      Answer({"segment", "mission/scene/scan.pcd", "--image", "mission/scene/image.png", "--rig",
              "rig.yaml", "--score-from", "20"});
  EXPECT_GT(things["score"]["weighted_overlap"], 0.86);
  EXPECT_GT(things["score"]["mean_f"], 0.9);
  EXPECT_EQ(things["score"]["found"], 1);
}

TEST_F(CommandTest, AMissionIsTheSameFromTheSameSeedAndNeedsAFolderOfItsOwn) {
  const auto simulate = [&](const char* seed, const char* folder) {
    return RunCommand({"simulate", "mission", "--robots", "2", "--minutes", "0.3", "--pictures",
                       "1", "--gnss", "0.5", "--seed", seed, "-o", Path(folder)});
  };
  ASSERT_EQ(simulate("1", "a").exit_code, 0);
  ASSERT_EQ(simulate("1", "b").exit_code, 0);
  ASSERT_EQ(simulate("2", "c").exit_code, 0);
  std::size_t files = 0, others = 0;
  for (const auto& entry : fs::recursive_directory_iterator(Path("a"))) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const std::string name = fs::relative(entry.path(), Path("a")).string();
    EXPECT_TRUE(ReadWhole(entry.path().string()) == ReadWhole(Path("b/" + name))) << name;
    others += ReadWhole(entry.path().string()) != ReadWhole(Path("c/" + name));
  }
  EXPECT_EQ(files, 22u);
  EXPECT_GT(others, 16u);
  const std::string readme = ReadWhole(Path("a/README.md"));
  for (const char* name : {"robot1", "graph.fg", "gnss.csv", "signal.csv", "cameras/target.yaml",
                           "scene/scan.pcd", "scene/image.png", "scene/points.csv",
                           "truth/map.yaml", "truth/links.csv", "truth/rig.yaml"})
    EXPECT_NE(readme.find(name), std::string::npos) << name;

  const Outcome again = simulate("1", "a");
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("is no empty folder"), std::string::npos) << again.err;
}

}  // namespace
}  // namespace graticule::test
