// Every command that writes, with each of its calls to the disk failing in turn: the failure is
// said, what is written is whole, and nothing else is left behind.  And every command that prints,
// onto a device that is full.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>

#include "../apps/command.hpp"

namespace graticule::test {
namespace {

namespace fs = std::filesystem;

// `words` with IN and OUT for the folders of what is read and written.  Of its calls so many are
// let fail, from the first to the last: fewer of commands that take long.
struct Scenario {
  const char* name;
  std::vector<std::string> words;
  int tries = 10;
  int exit_code = 0;  // where nothing fails
};

std::vector<std::string> Replaced(std::vector<std::string> words, const std::string& in,
                                  const std::string& out) {
  for (std::string& word : words) {
    for (const auto& [mark, folder] : {std::pair{"IN/", in + "/"}, std::pair{"OUT/", out + "/"}})
      for (std::size_t at; (at = word.find(mark)) != std::string::npos;)
        word.replace(at, std::string(mark).size(), folder);
  }
  return words;
}

// A camera that looks along its LIDAR's x, and what both have seen of points before it.
const char* const kCamera =
    "graticule-camera: 1\ncameras:\n  - name: front\n    model: pinhole\n    size: [640, 480]\n"
    "    parameters: [500, 500, 320, 240]\n    camera_from_rig: [0, 0, 0, 0, 0, 0, 1]\nend: 1\n";
std::string PointsOfBoth() {
  std::string text;
  for (int i = 0; i < 24; ++i) {
    const double x = 2 + 0.8 * (i * 7 % 11);
    const double y = x * 0.5 * ((i * 5 % 13 - 6) / 6.0), z = x * 0.35 * ((i * 3 % 7 - 3) / 3.0);
    const double u = 320 - 500 * y / x + 0.5 * ((i * 37 % 19 - 9) / 9.0);
    const double v = 240 - 500 * z / x + 0.5 * ((i * 11 % 17 - 8) / 8.0);
    for (const double number : {x, y, z, u}) text += std::to_string(number) + ',';
    text += std::to_string(v) + '\n';
  }
  return text;
}

// What a scenario reads: files that are written, and what commands make, of these what it names.
class Inputs {
 public:
  explicit Inputs(const std::vector<std::string>& words) {
    std::string name = (fs::temp_directory_path() / "graticule-faults-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    folder_ = name;
    std::ofstream(folder_ + "/square.g2o") << kSquare;
    std::ofstream(folder_ + "/team.csv") << "id,x,y\nrobot1,2,2\nrobot2,8,3\n";
    std::ofstream(folder_ + "/pairs.csv") << "rx_x,rx_y,tx_x,tx_y\n2,2,8,3\n";
    std::ofstream(folder_ + "/front.yaml") << kCamera;
    std::ofstream(folder_ + "/points.csv") << PointsOfBoth();
    for (const std::string& word : words) Make(word);
  }
  ~Inputs() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  const std::string& Folder() const { return folder_; }

 private:
  void Make(const std::string& needed) {
    static const std::map<std::string, std::vector<std::string>> kMade = {
        {"IN/city.fg", {"simulate", "city", "--robots", "2", "--poses", "40"}},
        {"IN/mission",
         {"simulate", "mission", "--minutes", "0.5", "--robots", "2", "--pictures", "0"}},
        {"IN/room", {"signal", "simulate", "room", "--seconds", "20", "--rate", "2"}},
        {"IN/model.fg", {"signal", "fit", "IN/room", "--method", "mrt"}},
        {"IN/hallway", {"simulate", "scene", "hallway"}},
        {"IN/camera.yaml",
         {"calibrate", "guide", "--headless", "--simulate", "corners", "--detections",
          "IN/corners.json"}}};
    const std::string file = needed == "IN/corners.json" ? "IN/camera.yaml" : needed;
    for (const auto& [made, how] : kMade) {
      if (file.compare(0, made.size(), made) != 0 || !made_.insert(made).second) continue;
      for (const std::string& word : how)
        if (word != "IN/corners.json") Make(word);
      std::vector<std::string> words = how;
      words.insert(words.end(), {"-o", made});
      const Outcome outcome = RunCommand(Replaced(words, folder_, ""));
      if (outcome.exit_code != 0) throw std::runtime_error(how[0] + ": " + outcome.err);
    }
  }

  std::string folder_;
  std::set<std::string> made_;
};

// Path in the folder -> contents.
using Tree = std::map<std::string, std::string>;
Tree Read(const std::string& folder) {
  Tree tree;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      tree[fs::relative(entry.path(), folder).string()] = ReadWhole(entry.path().string());
  return tree;
}

// The same, but for times and what follows from their number of digits.
bool Alike(const std::string& a, const std::string& b) {
  const std::size_t tail = std::min<std::size_t>({a.size(), b.size(), 8});
  return a.compare(a.size() - tail, tail, b, b.size() - tail, tail) == 0 &&
         std::max(a.size(), b.size()) - std::min(a.size(), b.size()) <= 200 + a.size() / 10;
}

class Faults : public testing::TestWithParam<Scenario> {
 protected:
  void SetUp() override { inputs_ = std::make_unique<Inputs>(GetParam().words); }

  struct Result {
    Outcome outcome;
    Tree files;
    long calls = 0;
  };
  Result Run(long failing, bool stays) const {
    const fs::path folder = fs::path(inputs_->Folder()) / "out";
    const std::string count = inputs_->Folder() + "/count";
    fs::remove_all(folder);
    fs::create_directory(folder);
    RunOptions options;
    options.environment = {{"LD_PRELOAD", GRATICULE_FAILING_CALLS},
                           {"FAILING_CALLS_UNDER", folder.string()},
                           {"FAILING_CALLS_AT", std::to_string(failing)},
                           {"FAILING_CALLS_STAY", stays ? "1" : "0"},
                           {"FAILING_CALLS_COUNT", count}};
    Result result;
    result.outcome =
        RunCommand(Replaced(GetParam().words, inputs_->Folder(), folder.string()), options);
    result.files = Read(folder.string());
    std::ifstream(count) >> result.calls;
    return result;
  }

  std::unique_ptr<Inputs> inputs_;
};

TEST_P(Faults, AreSaidAndLeaveNothingHalfWritten) {
  const Result whole = Run(0, false), again = Run(0, false);
  ASSERT_EQ(whole.outcome.exit_code, GetParam().exit_code) << whole.outcome.err;
  ASSERT_GT(whole.calls, 1);
  ASSERT_FALSE(whole.files.empty());

  const int tries = static_cast<int>(std::min<long>(GetParam().tries, whole.calls));
  for (const bool stays : {false, true})
    for (int i = 0; i < tries; ++i) {
      const long call = 1 + i * (whole.calls - 1) / (tries - 1);
      SCOPED_TRACE(testing::Message() << "call " << call << " of " << whole.calls
                                      << (stays ? " and all that follow fail" : " fails"));
      const Result result = Run(call, stays);
      EXPECT_EQ(result.outcome.exit_code, 1) << result.outcome.err;
      EXPECT_NE(result.outcome.err.find("No space left on device"), std::string::npos)
          << result.outcome.err;
      EXPECT_EQ(result.outcome.err.compare(0, 11, "graticule: "), 0) << result.outcome.err;
      for (const auto& [path, contents] : result.files) {
        ASSERT_TRUE(whole.files.count(path)) << path << " was left behind";
        if (fs::path(path).extension() == ".state") continue;  // of a search, as of an earlier step
        const std::string& expected = whole.files.at(path);
        if (expected == again.files.at(path))
          EXPECT_TRUE(contents == expected) << path << " is not as it should be";
        else
          EXPECT_TRUE(Alike(contents, expected)) << path << " is not whole";
      }
      if (HasFailure()) return;
    }
}

// What is printed goes to a device that is full.
class FullDevice : public Faults {};
TEST_P(FullDevice, IsSaid) {
  const fs::path folder = fs::path(inputs_->Folder()) / "out";
  fs::create_directory(folder);
  const auto words = Replaced(GetParam().words, inputs_->Folder(), folder.string());
  const Outcome whole = RunCommand(words);
  ASSERT_EQ(whole.exit_code, GetParam().exit_code) << whole.err;
  ASSERT_NE(whole.out, "");
  RunOptions full;
  full.stdout_path = "/dev/full";
  const Outcome outcome = RunCommand(words, full);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("graticule: could not write to the standard output"),
            std::string::npos)
      << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(
    Every, Faults,
    testing::Values(
        Scenario{"convert", {"convert", "IN/square.g2o", "OUT/a.fg.gz"}},
        Scenario{"solve",
                 {"solve", "IN/square.g2o", "-o", "OUT/a.g2o", "--report", "OUT/a.html",
                  "--trajectory", "OUT/a.tum", "--plot", "OUT/a.png", "--marginals", "all",
                  "--marginals-output", "OUT/m.json"},
                 4},
        Scenario{"compare",
                 {"compare", "IN/square.g2o", "--configs", "default", "dogleg", "--repeats", "1",
                  "--report", "OUT/a.html"}},
        Scenario{"compare_state",
                 {"compare", "IN/square.g2o", "IN/city.fg", "--configs", "default", "--repeats",
                  "1", "--state", "OUT/a.state", "--report", "OUT/a.json"}},
        Scenario{"simulate",
                 {"simulate", "city", "--robots", "2", "--poses", "40", "-o", "OUT/a.fg", "--truth",
                  "OUT/t.tum"}},
        Scenario{"simulate_bundle",
                 {"simulate", "bundle", "--cameras", "3", "--points", "8", "-o", "OUT/b.fg",
                  "--truth", "OUT/t.fg"}},
        Scenario{"corrupt",
                 {"simulate", "corrupt", "IN/city.fg", "--outlier-fraction", "0.2", "-o",
                  "OUT/a.g2o", "--outliers", "OUT/ids.json"}},
        Scenario{"simulate_mission",
                 {"simulate", "mission", "--minutes", "0.2", "--robots", "2", "--pictures", "0",
                  "--record", "--gnss", "1", "-o", "OUT/m"},
                 4},
        Scenario{"map",
                 {"map", "IN/mission/robot1.log", "IN/mission/robot2.log", "--start", "0,0,0",
                  "--start", "0,1,0", "--record", "-o", "OUT/map"},
                 4},
        Scenario{"signal_simulate",
                 {"signal", "simulate", "room", "--seconds", "10", "--rate", "1", "--maps", "-o",
                  "OUT/room"}},
        Scenario{"signal_fit",
                 {"signal", "fit", "IN/room", "--method", "matte", "-o", "OUT/m.fg", "--record",
                  "OUT/r.fg"}},
        Scenario{"signal_predict",
                 {"signal", "predict", "IN/model.fg", "--map", "IN/room/map.yaml", "--from", "2,2",
                  "--map-of", "OUT/strength"},
                 4},
        Scenario{"signal_draw",
                 {"signal", "draw", "IN/model.fg", "--map", "IN/room/map.yaml", "-o", "OUT/a.svg"}},
        Scenario{"signal_evaluate",
                 {"signal", "evaluate", "IN/room", "--methods", "log-fit", "--plot", "OUT/e.svg"}},
        Scenario{"signal_tune",
                 {"signal", "tune", "IN/room", "--methods", "mrt", "--most", "4", "-o",
                  "OUT/tuned.yaml"},
                 6,
                 4},
        Scenario{"simulate_scene", {"simulate", "scene", "hallway", "-o", "OUT/scene"}, 4},
        Scenario{"segment",
                 {"segment", "IN/hallway/scan.pcd", "--image", "IN/hallway/image.png", "--rig",
                  "IN/hallway/rig.yaml", "-o", "OUT/l.ply", "--picture", "OUT/l.png",
                  "--label-image", "OUT/i.png", "--report", "OUT/r.html"},
                 4},
        Scenario{"segment_evaluate",
                 {"segment", "evaluate", "IN/hallway/scan.pcd", "--methods", "normals", "--sweep",
                  "min-size=10,100", "--plot", "OUT/s.svg", "--report", "OUT/s.html"},
                 4},
        Scenario{"coregister",
                 {"coregister", "--camera", "IN/front.yaml", "--points", "IN/points.csv", "-o",
                  "OUT/rig.yaml", "--plot", "OUT/r.svg", "--error-map", "OUT/e.png", "--record",
                  "OUT/c.fg"},
                 6},
        Scenario{"calibrate",
                 {"calibrate", "IN/corners.json", "--model", "angular4", "-o", "OUT/c.yaml", "-o",
                  "kalibr:OUT/k.yaml", "--report", "OUT/r.html", "--pictures", "OUT/p", "--record",
                  "OUT/p.fg"},
                 4},
        Scenario{"calibrate_evaluate",
                 {"calibrate", "evaluate", "IN/camera.yaml", "IN/corners.json", "--against",
                  "IN/camera.yaml", "--plot", "OUT/d.svg"},
                 4},
        Scenario{"calibrate_guide",
                 {"calibrate", "guide", "--headless", "--simulate", "corners", "-o", "OUT/c.yaml",
                  "--detections", "OUT/d.json"},
                 4},
        Scenario{"calibrate_target", {"calibrate", "target", "-o", "OUT/t.pdf"}, 4},
        Scenario{"manual_pages", {"manual", "man", "-o", "OUT/man"}},
        Scenario{"manual_shell", {"manual", "bash", "-o", "OUT/graticule"}}),
    [](const auto& scenario) { return std::string(scenario.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Every, FullDevice,
    testing::Values(
        Scenario{"solve", {"solve", "IN/square.g2o", "--json"}},
        Scenario{"compare", {"compare", "IN/square.g2o", "--configs", "default", "--json"}},
        Scenario{"inspect", {"inspect", "IN/city.fg", "--json"}},
        Scenario{"check", {"check", "IN/square.g2o"}}, Scenario{"options", {"options"}},
        Scenario{"types", {"types"}}, Scenario{"manual", {"manual", "markdown"}},
        Scenario{"signal_predict",
                 {"signal", "predict", "IN/model.fg", "--map", "IN/room/map.yaml", "--pairs",
                  "IN/pairs.csv"}},
        Scenario{"signal_connect",
                 {"signal", "connect", "IN/model.fg", "IN/team.csv", "--map", "IN/room/map.yaml"}},
        Scenario{"signal_where",
                 {"signal", "where", "IN/model.fg", "IN/team.csv", "--robot", "robot2", "--map",
                  "IN/room/map.yaml"}},
        Scenario{"signal_evaluate",
                 {"signal", "evaluate", "IN/room", "--methods", "log-fit", "--json"}},
        Scenario{"segment", {"segment", "IN/hallway/scan.pcd"}},
        Scenario{"segment_evaluate",
                 {"segment", "evaluate", "IN/hallway/scan.pcd", "--methods", "normals"}},
        Scenario{"coregister",
                 {"coregister", "--camera", "IN/front.yaml", "--points", "IN/points.csv"}},
        Scenario{"calibrate", {"calibrate", "IN/corners.json", "--model", "angular4", "--json"}},
        Scenario{"calibrate_evaluate",
                 {"calibrate", "evaluate", "IN/camera.yaml", "IN/corners.json"}},
        Scenario{"map",
                 {"map", "IN/mission/robot1.log", "--start", "0,0,0", "-o", "OUT/map", "--json"}}),
    [](const auto& scenario) { return std::string(scenario.param.name); });

}  // namespace
}  // namespace graticule::test
