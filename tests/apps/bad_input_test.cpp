// What is refused: in one line that names the place, with the exit code of docs/command.md, and
// without a trace in the folder.

#include <sys/mount.h>
#include <unistd.h>

#include <fstream>

#include "../io/broken_files.hpp"
#include "command.hpp"

namespace graticule::test {
namespace {

namespace fs = std::filesystem;

class BadInput : public CommandTest {
 protected:
  // One line on stderr that begins with `begin` and holds `part`; nothing on stdout.
  static void ExpectRefusal(const Outcome& outcome, int exit_code, const std::string& begin,
                            const std::string& part = "") {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
    EXPECT_EQ(outcome.err.compare(0, begin.size(), begin), 0) << outcome.err << "instead of\n"
                                                              << begin;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err << "without " << part;
  }
  // A usage error: the line, and a hint where help is.
  static void ExpectUsage(const Outcome& outcome, const std::string& part) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.compare(0, 11, "graticule: "), 0) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err << "without " << part;
    EXPECT_LE(CountLines(outcome.err), 2u) << outcome.err;
  }
  std::string Square() const { return Write("square.g2o", kSquare); }
};

TEST_F(BadInput, EveryBrokenFileIsRefusedAtItsPlaceByEveryCommand) {
  for (const BrokenFile& broken : kBrokenFiles) {
    SCOPED_TRACE(broken.name);
    const std::string file = std::string(GRATICULE_BROKEN_DIR "/") + broken.name;
    const std::string ending = fs::path(broken.name).extension().string();
    if (ending == ".yaml" || ending == ".tum" || ending == ".clf" || ending == ".relations")
      continue;
    const std::string begin =
        "graticule: " + file + (*broken.place ? std::string(":") + broken.place : "") + ": ";
    const bool type_missing =
        std::string(broken.message).find("is not loaded") != std::string::npos;
    const int exit_code = type_missing ? 6 : 3;
    ExpectRefusal(RunCommand({"solve", file, "-o", Path("out.fg")}), exit_code, begin);
    ExpectRefusal(RunCommand({"convert", file, Path("out.fg")}), exit_code, begin);
    ExpectRefusal(RunCommand({"inspect", file}), exit_code, begin);
    EXPECT_TRUE(Files().empty()) << Files()[0] << " is left";
  }
}

TEST_F(BadInput, EveryBrokenLogIsRefusedAtItsPlace) {
  for (const BrokenFile& broken : kBrokenFiles) {
    SCOPED_TRACE(broken.name);
    const std::string file = std::string(GRATICULE_BROKEN_DIR "/") + broken.name;
    if (fs::path(broken.name).extension() != ".clf") continue;
    ExpectRefusal(RunCommand({"map", file, "-o", Path("out")}), 3,
                  "graticule: " + file + ":" + broken.place + ": ");
    EXPECT_TRUE(fs::is_empty(Path("out")));
  }
}

TEST_F(BadInput, EveryBrokenConfigurationIsRefusedAtItsPlace) {
  const std::string square = Square();
  for (const BrokenFile& broken : kBrokenFiles) {
    const std::string file = std::string(GRATICULE_BROKEN_DIR "/") + broken.name;
    if (fs::path(broken.name).extension() != ".yaml") continue;
    ExpectRefusal(RunCommand({"solve", square, "-o", Path("out.fg"), "--config", file}), 3,
                  "graticule: " + file + ":" + broken.place + ": ");
    EXPECT_EQ(Files().size(), 1u);
  }
}

TEST_F(BadInput, AnOptionInAConfigurationIsRefusedAtItsLine) {
  const std::string square = Square();
  const std::string unknown = Write("unknown.yaml", "threads: 1\nmax_iteration: 5\n");
  ExpectRefusal(RunCommand({"solve", square, "--config", unknown}), 2,
                "graticule: " + unknown + ":2:", "did you mean 'max_iterations'?");
  const std::string value = Write("value.yaml", "threads: 1\nmax_iterations: -5\n");
  ExpectRefusal(RunCommand({"solve", square, "--config", value}), 2,
                "graticule: " + value + ":2:", "max_iterations");
}

// Where no problem is read, its options would do nothing.
TEST_F(BadInput, OptionsOfReadingAreUnknownToCommandsThatReadNoProblem) {
  using Words = std::vector<std::string>;
  for (Words words : {Words{"calibrate", "set.json"}, Words{"calibrate", "guide"},
                      Words{"coregister", "--camera", "camera.yaml"}, Words{"types"}}) {
    words.emplace_back("--skip-unknown");
    ExpectUsage(RunCommand(words), "--skip-unknown");
  }
}

TEST_F(BadInput, AMissingFileAFolderAndNothingAreRefusedByName) {
  const std::string missing = Path("missing.g2o");
  const std::string folder = Path("folder.g2o");
  fs::create_directory(folder);
  for (const char* command : {"solve", "inspect", "check"}) {
    ExpectRefusal(RunCommand({command, missing}), 3, "graticule: " + missing + ": ",
                  "No such file");
    ExpectRefusal(RunCommand({command, folder}), 3, "graticule: " + folder + ": ", "directory");
    EXPECT_NE(RunCommand({command, ""}).exit_code, 0);
    EXPECT_EQ(CountLines(RunCommand({command, ""}).err), 1u);
  }
  ExpectRefusal(RunCommand({"convert", missing, Path("out.fg")}), 3,
                "graticule: " + missing + ": ");
  EXPECT_EQ(Files(), std::vector<std::string>{"folder.g2o"});
}

TEST_F(BadInput, AFileThatMayNotBeReadIsRefusedByName) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const std::string square = Square();
  fs::permissions(square, fs::perms::none);
  ExpectRefusal(RunCommand({"solve", square}), 3, "graticule: " + square + ": ",
                "Permission denied");
}

TEST_F(BadInput, WordsThatAreNotUnderstoodAreUsageErrors) {
  const std::string square = Square();
  ExpectUsage(RunCommand({}), "subcommand");
  ExpectUsage(RunCommand({"slove", square}), "slove");
  ExpectUsage(RunCommand({"solve"}), "FILE");
  ExpectUsage(RunCommand({"solve", square, "--jason"}), "--jason");
  ExpectUsage(RunCommand({"solve", square, square}), square);
  ExpectUsage(RunCommand({"solve", square, "--g2o-rotation", "quarter"}), "quarter");
  ExpectUsage(RunCommand({"solve", square, "--marginals-output", Path("m.json")}), "--marginals");
  ExpectUsage(RunCommand({"compare", square}), "--configs");
  ExpectUsage(RunCommand({"simulate", "village", "-o", Path("v.fg")}), "village");
  EXPECT_EQ(Files(), std::vector<std::string>{"square.g2o"});
}

TEST_F(BadInput, OptionsThatDoNotExistOrFitSuggestWhatDoes) {
  const std::string square = Square();
  const auto set = [&](const std::string& words) {
    return RunCommand({"solve", square, "--set", words});
  };
  ExpectRefusal(set("max_iteration=5"), 2, "graticule: ", "did you mean 'max_iterations'?");
  ExpectRefusal(set("initialize=file"), 2, "graticule: ", "did you mean 'initialise'?");
  ExpectRefusal(set("threads"), 2, "graticule: --set: ", "name=value");
  ExpectRefusal(set("threads=0"), 2, "graticule: option threads: ", "an integer >= 1");
  ExpectRefusal(set("threads=two"), 2, "graticule: option threads: ", "'two'");
  ExpectRefusal(set("method=newton"), 2, "graticule: option method: ", "gauss_newton");
  ExpectRefusal(set("time_limit_s=nan"), 2, "graticule: option time_limit_s: ", "'nan'");
  ExpectRefusal(RunCommand({"solve", square, "--config", "doglegs"}), 2,
                "graticule: ", "did you mean 'dogleg'?");
  ExpectRefusal(RunCommand({"solve", square, "--config", Path("none.yaml")}), 3,
                "graticule: " + Path("none.yaml") + ": ");
}

TEST_F(BadInput, EndingsThatNoFormatHasAreRefusedBeforeTheSolve) {
  const std::string square = Square();
  ExpectRefusal(RunCommand({"solve", square, "--report", Path("r.pdf")}), 2,
                "graticule: --report: ", ".html or .json");
  ExpectRefusal(RunCommand({"solve", square, "--plot", Path("p.jpg")}), 2,
                "graticule: --plot: ", ".svg or .png");
  ExpectRefusal(RunCommand({"solve", square, "-o", Path("o.doc")}), 2, "graticule: -o: ", ".fg");
  ExpectRefusal(RunCommand({"convert", square, Path("o.doc")}), 2, "graticule: OUT: ", ".fg");
  ExpectRefusal(RunCommand({"compare", square, "--configs", "default", "--report", Path("r.txt")}),
                2, "graticule: --report: ", ".html or .json");
  EXPECT_EQ(Files(), std::vector<std::string>{"square.g2o"});
}

TEST_F(BadInput, OutputsThatCannotBeMadeAreRefusedBeforeTheSolve) {
  const std::string square = Square();
  // Not even root can make a file below a file.
  for (const std::string& folder : {Path("no/such/folder"), square}) {
    const std::string out = folder + "/out.fg";
    ExpectRefusal(RunCommand({"solve", square, "-o", out}), 1, "graticule: " + out + ": ");
    ExpectRefusal(RunCommand({"solve", square, "--trajectory", out}), 1,
                  "graticule: " + out + ": ");
    ExpectRefusal(RunCommand({"convert", square, out}), 1, "graticule: " + out + ": ");
    ExpectRefusal(RunCommand({"simulate", "city", "--poses", "10", "-o", out}), 1,
                  "graticule: " + out + ": ");
  }
  fs::create_directory(Path("taken.fg"));
  ExpectRefusal(RunCommand({"solve", square, "-o", Path("taken.fg")}), 1,
                "graticule: " + Path("taken.fg") + ": ");
  EXPECT_EQ(Files(), (std::vector<std::string>{"square.g2o", "taken.fg"}));
}

// A disk that is full, as far as it can be had without mounting one.
TEST_F(BadInput, AnOutputThatFillsUpCostsThatOutputOnly) {
  fs::create_symlink("/dev/full", Path("out.fg"));
  const Outcome outcome = RunCommand(
      {"solve", Square(), "-o", Path("out.fg"), "--trajectory", Path("out.tum"), "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "graticule: " + Path("out.fg") + ": No space left on device\n");
  EXPECT_EQ(JsonOf(outcome)["outputs"], std::vector<std::string>{Path("out.tum")});
  EXPECT_EQ(Files(), (std::vector<std::string>{"out.fg", "out.tum", "square.g2o"}));
}

TEST_F(BadInput, ADeviceThatIsFullIsAnErrorOfItsOwn) {
  const std::string square = Square();
  RunOptions full;
  full.stdout_path = "/dev/full";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"solve", square, "--json"},
        {"inspect", square},
        {"check", square},
        {"compare", square, "--configs", "default", "--repeats", "1"},
        {"options"},
        {"--version"},
        {"--help"}}) {
    const Outcome outcome = RunCommand(words, full);
    EXPECT_EQ(outcome.exit_code, 1) << words[0];
    EXPECT_NE(outcome.err.find("graticule: could not write to the standard output"),
              std::string::npos)
        << words[0] << ": " << outcome.err;
  }
}

// A disk of its own, small enough to fill.
class FullDisk : public BadInput {
 protected:
  void SetUp() override {
    BadInput::SetUp();
    fs::create_directory(Path("disk"));
    if (mount("tmpfs", Path("disk").c_str(), "tmpfs", 0, "size=64k") != 0)
      GTEST_SKIP() << "mounting a small disk is not permitted here";
    mounted_ = true;
  }
  void TearDown() override {
    if (mounted_) umount(Path("disk").c_str());
    BadInput::TearDown();
  }
  std::vector<std::string> OnDisk() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(Path("disk")))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  bool mounted_ = false;
};

TEST_F(FullDisk, LeavesOldOutputsWholeNoTemporariesAndCostsNoOtherOutput) {
  const std::string city = Path("city.fg");
  ASSERT_EQ(
      RunCommand({"simulate", "city", "--robots", "1", "--poses", "1000", "-o", city}).exit_code,
      0);
  for (const char* name : {"disk/out.fg", "disk/plot.svg"}) Write(name, "what was there before\n");
  Write("disk/fill", std::string(50 << 10, 'x'));
  const Outcome outcome =
      RunCommand({"solve", city, "-o", Path("disk/out.fg"), "--plot", Path("disk/plot.svg"),
                  "--trajectory", Path("out.tum"), "--report", Path("report.json"), "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find(Path("disk/out.fg") + ": No space left on device"), std::string::npos)
      << outcome.err;
  EXPECT_TRUE(ReadWhole(Path("disk/out.fg")) == "what was there before\n");
  EXPECT_TRUE(ReadWhole(Path("disk/plot.svg")) == "what was there before\n");
  EXPECT_EQ(OnDisk(), (std::vector<std::string>{"fill", "out.fg", "plot.svg"}));
  EXPECT_EQ(CountLines(ReadWhole(Path("out.tum"))), 1000u);
  const auto report = JsonOf(outcome);
  EXPECT_EQ(report["termination"], "converged");
  EXPECT_EQ(report["outputs"], (std::vector<std::string>{Path("out.tum"), Path("report.json")}));

  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"convert", city, Path("disk/out.fg")},
        {"simulate", "city", "-o", Path("disk/out.fg")}}) {
    ExpectRefusal(RunCommand(words), 1, "graticule: " + Path("disk/out.fg") + ": No space left");
    EXPECT_TRUE(ReadWhole(Path("disk/out.fg")) == "what was there before\n");
    EXPECT_EQ(OnDisk(), (std::vector<std::string>{"fill", "out.fg", "plot.svg"}));
  }
}

TEST_F(FullDisk, DoesNotCostAComparisonItsTable) {
  const std::string square = Square();
  Write("disk/fill", std::string(60 << 10, 'x'));
  const Outcome outcome = RunCommand({"compare", square, "--configs", "default", "--repeats", "1",
                                      "--report", Path("disk/report.html")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("default"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("No space left"), std::string::npos);
  EXPECT_EQ(OnDisk(), std::vector<std::string>{"fill"});
}

}  // namespace
}  // namespace graticule::test
