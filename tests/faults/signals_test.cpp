// SIGINT and SIGTERM at any time: what is written is whole and loads, and a search goes on where it
// was.

#include <signal.h>

#include <chrono>
#include <filesystem>

#include "../apps/command.hpp"

namespace graticule::test {
namespace {

class Signals : public CommandTest {
 protected:
  static constexpr int kTimes = 6;

  Outcome Run(const std::vector<std::string>& words) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = RunCommand(words);
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return outcome;
  }

  // Spread over what the last Run took, and a little beyond.
  Outcome RunAndSignal(const std::vector<std::string>& words, int time) {
    RunOptions options;
    options.signal = time % 2 ? SIGINT : SIGTERM;
    options.signal_after_s = seconds_ * 1.1 * (time + 0.5) / kTimes;
    const Outcome outcome = RunCommand(words, options);
    // Not yet or no longer minded: ended by the signal, as is the custom.
    const bool killed = outcome.exit_code == 128 + options.signal;
    EXPECT_TRUE(killed || outcome.exit_code == 0 || outcome.exit_code == 4)
        << outcome.exit_code << ": " << outcome.err;
    stopped_ += outcome.exit_code == 4;
    return outcome;
  }

  void ExpectNoTemporaries() {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  }

  double seconds_ = 0;
  int stopped_ = 0;
};

TEST_F(Signals, ToASolve) {
  ASSERT_EQ(RunCommand({"simulate", "city", "--robots", "8", "--poses", "5000", "-o",
                        Path("city.fg"), "--binary"})
                .exit_code,
            0);
  const std::vector<std::string> words = {"solve", Path("city.fg"),       "-s", "initialise=file",
                                          "-s",    "max_iterations=1000", "-o", Path("solved.fg")};
  ASSERT_EQ(Run(words).exit_code, 0);
  for (int time = 0; time < kTimes; ++time) {
    std::filesystem::remove(Path("solved.fg"));
    const Outcome outcome = RunAndSignal(words, time);
    ExpectNoTemporaries();
    const bool written = std::filesystem::exists(Path("solved.fg"));
    EXPECT_TRUE(written || outcome.exit_code >= 128) << outcome.err;
    if (written) {
      EXPECT_EQ(RunCommand({"inspect", Path("solved.fg")}).exit_code, 0);
    }
  }
  EXPECT_GT(stopped_, 0);
}

TEST_F(Signals, ToAMap) {
  ASSERT_EQ(RunCommand({"simulate", "mission", "--minutes", "1.5", "--robots", "2", "--pictures",
                        "0", "-o", Path("mission")})
                .exit_code,
            0);
  const std::vector<std::string> words = {"map",
                                          Path("mission/robot1.log"),
                                          Path("mission/robot2.log"),
                                          "--start",
                                          "0,0,0",
                                          "--start",
                                          "0,1,0",
                                          "-o",
                                          Path("map")};
  ASSERT_EQ(Run(words).exit_code, 0);
  for (int time = 0; time < kTimes; ++time) {
    std::filesystem::remove_all(Path("map"));
    const Outcome outcome = RunAndSignal(words, time);
    ExpectNoTemporaries();
    // What was mapped so far is a map and a graph.
    if (outcome.exit_code >= 128) continue;
    EXPECT_TRUE(std::filesystem::exists(Path("map/map.yaml")));
    EXPECT_EQ(RunCommand({"inspect", Path("map/graph.fg")}).exit_code, 0);
  }
}

TEST_F(Signals, ToACertificate) {
  // Wrong loop closures: the certificate is refused, and other starts are tried.
  ASSERT_EQ(RunCommand({"simulate", "city", "--robots", "4", "--poses", "1500",
                        "--outlier-fraction", "0.1", "-o", Path("city.fg"), "--binary"})
                .exit_code,
            0);
  const std::vector<std::string> words = {"solve", Path("city.fg"), "--certify", "-o",
                                          Path("solved.fg")};
  const Outcome whole = Run(words);
  ASSERT_TRUE(whole.exit_code == 0 || whole.exit_code == 4) << whole.err;
  for (int time = 0; time < kTimes; ++time) {
    std::filesystem::remove(Path("solved.fg"));
    const Outcome outcome = RunAndSignal(words, time);
    ExpectNoTemporaries();
    if (outcome.exit_code >= 128) continue;
    EXPECT_EQ(RunCommand({"inspect", Path("solved.fg")}).exit_code, 0);
  }
  EXPECT_GT(stopped_, 0);
}

TEST_F(Signals, ToACalibration) {
  ASSERT_EQ(RunCommand({"calibrate", "guide", "--headless", "--simulate", "corners", "-o",
                        Path("guided.yaml"), "--detections", Path("corners.json")})
                .exit_code,
            0);
  const std::vector<std::string> words = {"calibrate",    Path("corners.json"), "-o",
                                          Path("a.yaml"), "--detections",       Path("d.json")};
  ASSERT_EQ(Run(words).exit_code, 0);
  for (int time = 0; time < kTimes; ++time) {
    for (const char* file : {"a.yaml", "d.json"}) std::filesystem::remove(Path(file));
    const Outcome outcome = RunAndSignal(words, time);
    ExpectNoTemporaries();
    const bool written = std::filesystem::exists(Path("a.yaml"));
    EXPECT_EQ(written, outcome.exit_code == 0) << outcome.err;
    if (outcome.exit_code != 4) continue;
    EXPECT_NE(outcome.err.find("stopped before there was a camera"), std::string::npos);
    EXPECT_EQ(ReadWhole(Path("d.json")), ReadWhole(Path("corners.json")));
  }
  EXPECT_GT(stopped_, 0);
}

TEST_F(Signals, ToATuning) {
  ASSERT_EQ(RunCommand({"signal", "simulate", "room", "--seconds", "120", "--rate", "4", "-o",
                        Path("room")})
                .exit_code,
            0);
  const std::vector<std::string> words = {"signal", "tune", Path("room"), "--methods",       "mrt",
                                          "--most", "30",   "-o",         Path("tuned.yaml")};
  const auto clear = [&] {
    for (const std::string& file : Files())
      if (file != "room") std::filesystem::remove(Path(file));
  };
  Run(words);
  const std::string expected = ReadWhole(Path("tuned.yaml"));
  ASSERT_NE(expected, "");
  for (int time = 0; time < kTimes; ++time) {
    clear();
    RunAndSignal(words, time);
    ExpectNoTemporaries();
    const Outcome again = RunCommand(words);
    EXPECT_TRUE(again.exit_code == 0 || again.exit_code == 4) << again.err;
    EXPECT_EQ(ReadWhole(Path("tuned.yaml")), expected) << "stopped and gone on";
  }
}

}  // namespace
}  // namespace graticule::test
