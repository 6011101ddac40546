// With little memory (ulimit -v): an error and an exit code, never an abort, a hang or a
// half-written file.

#include <algorithm>

#include "../apps/command.hpp"

namespace graticule::test {
namespace {

constexpr std::size_t kMegabyte = 1 << 20;

class LittleMemory : public CommandTest {
 protected:
  void Make(const std::vector<std::string>& words) {
    const Outcome outcome = RunCommand(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  // From so little that the program itself does not fit, to enough.
  void ExpectAnErrorOrSuccess(const std::vector<std::string>& words, std::size_t most_mb) {
    int failed = 0, done = 0;
    for (std::size_t megabytes = 60; megabytes <= most_mb;
         megabytes += std::max<std::size_t>(megabytes / 8, 12)) {
      SCOPED_TRACE(testing::Message() << megabytes << " MB");
      RunOptions options;
      options.memory_bytes = megabytes * kMegabyte;
      options.timeout_s = 120;
      const Outcome outcome = RunCommand(words, options);
      for (const std::string& file : Files())
        EXPECT_EQ(file.find(".tmp"), std::string::npos) << file;
      if (outcome.exit_code == 0) {
        ++done;
        continue;
      }
      ++failed;
      // 127: the system's loader, which says so itself.
      EXPECT_TRUE(outcome.exit_code == 1 || outcome.exit_code == 127)
          << outcome.exit_code << ": " << outcome.err;
      EXPECT_NE(outcome.err, "");
    }
    EXPECT_GT(failed, 2);
    EXPECT_GT(done, 0);
  }
};

TEST_F(LittleMemory, OfASolve) {
  Make({"simulate", "city", "--robots", "4", "--poses", "1500", "-o", Path("city.fg"), "--binary"});
  ExpectAnErrorOrSuccess({"solve", Path("city.fg"), "-o", Path("solved.fg")}, 700);
}

TEST_F(LittleMemory, OfABundle) {
  Make({"simulate", "bundle", "--cameras", "30", "--points", "3000", "-o", Path("ring.fg"),
        "--binary"});
  ExpectAnErrorOrSuccess({"solve", Path("ring.fg"), "-o", Path("solved.fg")}, 900);
}

TEST_F(LittleMemory, OfAPicture) {
  Write("square.g2o", kSquare);
  ExpectAnErrorOrSuccess({"solve", Path("square.g2o"), "--plot", Path("square.png")}, 900);
}

TEST_F(LittleMemory, OfASignal) {
  Make({"signal", "simulate", "room", "--seconds", "30", "--rate", "2", "-o", Path("room")});
  ExpectAnErrorOrSuccess({"signal", "fit", Path("room"), "--method", "best", "-o", Path("model")},
                         700);
}

// Where the system makes fewer threads than are asked for, they do the same work.
class FewThreads : public CommandTest {};

TEST_F(FewThreads, ChangeNoDigitOfASolve) {
  Write("square.g2o", kSquare);
  const auto solved = [&](const char* most) {
    RunOptions options;
    options.environment = {{"LD_PRELOAD", GRATICULE_FAILING_CALLS}, {"OPENBLAS_NUM_THREADS", "1"}};
    if (most) options.environment["FAILING_CALLS_THREADS"] = most;
    const Outcome outcome = RunCommand(
        {"solve", Path("square.g2o"), "--set", "threads=8", "-o", Path("solved.g2o")}, options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return ReadWhole(Path("solved.g2o"));
  };
  const std::string all = solved(nullptr);
  for (const char* most : {"0", "1", "3"}) EXPECT_EQ(solved(most), all) << most << " threads";
}

}  // namespace
}  // namespace graticule::test
