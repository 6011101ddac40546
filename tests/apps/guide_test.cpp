// What `graticule calibrate guide` promises to people and to programs.

#include <cstdlib>
#include <fstream>
#include <future>

#include "command.hpp"
#include "http_client.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

class Guide : public CommandTest {};

TEST_F(Guide, BringsASimulatedPersonToTheAccuracy) {
  const std::string camera = Path("camera.yaml"), detections = Path("detections.json");
  const Outcome outcome =
      RunCommand({"calibrate", "guide", "--headless", "--simulate", "--accuracy", "0.5", "-o",
                  camera, "-o", "ros:" + Path("info.yaml"), "--detections", detections, "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const Json json = JsonOf(outcome);
  EXPECT_TRUE(json["met"]);
  EXPECT_LE(json["max_ere_px"], 0.5);
  EXPECT_GE(json["frames"], 3);
  EXPECT_LE(json["frames"], 8);
  // The detections are libapriltag's on rendered tags, whose errors are not quite independent.
  EXPECT_LT(json["largest_error_px"], 1.5);
  for (const auto& [name, parameter] : json["parameters"].items())
    EXPECT_TRUE(parameter["constrained"]) << name;
  EXPECT_EQ(Files(), (std::vector<std::string>{"camera.yaml", "detections.json", "info.yaml"}));
  // The same corners make the same camera by themselves.
  const Json again = JsonOf(
      RunCommand({"calibrate", detections, "--model", "angular4", "--board", "flat", "--json"}));
  EXPECT_FALSE(again.empty());
}

TEST_F(Guide, HasTheSameDigitsAgainAndASynonym) {
  std::string files[2];
  for (const int i : {0, 1}) {
    const std::string camera = Path(std::to_string(i) + ".yaml");
    std::vector<std::string> words = {"calibrate", "--guide", "--headless", "--simulate", "corners",
                                      "--lens",    "a",       "-o",         camera};
    if (i == 1) {
      words.erase(words.begin() + 1);
      words.insert(words.begin() + 1, "guide");
    }
    EXPECT_EQ(RunCommand(words).exit_code, 0);
    files[i] = ReadWhole(camera);
  }
  EXPECT_EQ(files[0], files[1]);
  EXPECT_NE(files[0], "");
}

class GuideOfPictures : public CommandTest {};

TEST_F(GuideOfPictures, TakesEveryPictureOfAFolder) {
  const std::filesystem::path pictures =
      std::filesystem::path(GRATICULE_DATA_DIR) / "calib/opencv_samples/images";
  const char* is_ci = std::getenv("CI");
  if (!std::filesystem::exists(pictures)) {
    if (is_ci && std::string(is_ci) == "true") FAIL() << pictures << " is missing";
    GTEST_SKIP() << pictures << " is missing";
  }
  const std::filesystem::path folder = Path("pictures");
  std::filesystem::create_directory(folder);
  for (const auto& entry : std::filesystem::directory_iterator(pictures))
    if (entry.path().filename().string().rfind("left", 0) == 0)
      std::filesystem::copy(entry.path(), folder / entry.path().filename());
  std::ofstream(folder / "notes.txt") << "no picture";
  std::ofstream(folder / "left99.jpg") << "broken";
  const std::string board = Path("board.yaml");
  ASSERT_EQ(RunCommand({"calibrate", "target", "--kind", "chessboard", "--size", "A3", "--pitch",
                        "25", "--columns", "9", "--rows", "6", "-o", Path("board.svg")})
                .exit_code,
            0);
  const Outcome outcome =
      RunCommand({"calibrate", "guide", "--headless", "--folder", folder.string(), "--target",
                  board, "--model", "brown5", "--accuracy", "0.01", "--json"});
  const Json json = JsonOf(outcome);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(json["frames"], 13);
  EXPECT_FALSE(json["met"]);
  EXPECT_LT(json["rms_px"], 0.2);
}

TEST_F(Guide, SaysWhatIsNotKnownWhenItEndsEarly) {
  const Outcome none = RunCommand({"calibrate", "guide", "--headless", "--simulate", "corners",
                                   "--frames", "5", "-o", Path("camera.yaml")});
  EXPECT_EQ(none.exit_code, 5);
  EXPECT_NE(none.err.find("nothing is known of the camera"), std::string::npos) << none.err;
  EXPECT_TRUE(Files().empty());
}

TEST_F(Guide, RefusesWhatItCannotDo) {
  const auto refused = [](std::vector<std::string> words, int code, const std::string& said) {
    words.insert(words.begin(), {"calibrate", "guide", "--headless"});
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(said), std::string::npos) << outcome.err;
  };
  refused({"--simulate", "--camera", "0"}, 2, "expected one of --camera");
  refused({"--simulate", "corners", "--lens", "q"}, 2, "expected the letter");
  refused({"--simulate", "corners", "--model", "angular9"}, 2, "angular9");
  refused({"--camera", "250"}, 3, "camera 250: there is no such camera");
  refused({"--video", Path("none.avi")}, 3, "none.avi: no video");
  refused({"--folder", Path("none")}, 3, "none");
  refused({"--simulate", "--target", Path("none.yaml")}, 3, "none.yaml");
  refused({"--simulate", "-o", "nowhere:" + Path("c.yaml")}, 2, "nowhere");
  Write("film.avi", "no film at all");
  refused({"--video", Path("film.avi")}, 3, "film.avi: no video");
  std::filesystem::create_directory(Path("empty"));
  refused({"--folder", Path("empty")}, 3, "empty: there is no picture");
  refused({"--simulate", "-o", Path("nowhere/camera.yaml")}, 1, "nowhere");
  refused({"--simulate", "--detections", Path("nowhere/frames.json")}, 1, "nowhere");
}

TEST_F(Guide, SaysWhereItCannotListen) {
  const int taken = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(bind(taken, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(taken, 1), 0);
  getsockname(taken, reinterpret_cast<sockaddr*>(&address), &size);
  const Outcome port = RunCommand({"calibrate", "guide", "--simulate", "corners", "--port",
                                   std::to_string(ntohs(address.sin_port))});
  close(taken);
  EXPECT_EQ(port.exit_code, 1);
  EXPECT_NE(port.err.find("cannot listen there: Address already in use"), std::string::npos)
      << port.err;
  // Of nobody (RFC 5737).
  const Outcome host =
      RunCommand({"calibrate", "guide", "--simulate", "corners", "--listen", "203.0.113.7"});
  EXPECT_EQ(host.exit_code, 2);
  EXPECT_NE(host.err.find("cannot listen there: Cannot assign"), std::string::npos) << host.err;
}

TEST_F(Guide, WritesWhatIsKnownWhenItIsInterrupted) {
  RunOptions options;
  options.interrupt_at = "2 frames";
  const Outcome outcome = RunCommand(
      {"calibrate", "guide", "--simulate", "corners", "-o", Path("camera.yaml")}, options);
  EXPECT_EQ(outcome.exit_code, 5) << outcome.err;  // two frames are no calibration yet
  EXPECT_NE(outcome.out.find("not met"), std::string::npos) << outcome.out;
  EXPECT_EQ(Files(), std::vector<std::string>{"camera.yaml"});
}

// A port that was free a moment ago.
int FreePort() {
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  bind(probe, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
  close(probe);
  return ntohs(address.sin_port);
}

TEST_F(Guide, IsLedThroughItsPage) {
  const int port = FreePort();
  const std::string camera = Path("camera.yaml");
  std::future<Outcome> running = std::async(std::launch::async, [&] {
    return RunCommand({"calibrate", "guide", "--simulate", "corners", "--port",
                       std::to_string(port), "-o", camera});
  });
  const auto session = [&] {
    for (int i = 0; i < 300; ++i) {
      const std::string body = BodyOf(Asked(port, Request("GET", "/session.json")));
      if (!body.empty()) return Json::parse(body);
      usleep(20000);
    }
    return Json{};
  };
  Json now = session();
  for (int i = 0; i < 1500 && now.is_object() && !now["met"]; ++i) {
    usleep(20000);
    now = session();
  }
  ASSERT_TRUE(now.is_object());
  EXPECT_TRUE(now["met"]);
  // Its file is there before the end, and the page goes on.
  for (int i = 0; i < 250 && Files() != std::vector<std::string>{"camera.yaml"}; ++i) usleep(20000);
  EXPECT_EQ(Files(), std::vector<std::string>{"camera.yaml"});
  EXPECT_EQ(StatusOf(Asked(port, Request("GET", "/"))), 200);
  EXPECT_EQ(StatusOf(Asked(port, Request("POST", "/close", "X-Graticule: 1\r\n"))), 200);
  const Outcome outcome = running.get();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("open http://127.0.0.1:" + std::to_string(port) + "/"),
            std::string::npos);
  EXPECT_NE(outcome.out.find("1 px asked for: met"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace graticule::test
