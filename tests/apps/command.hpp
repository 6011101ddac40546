#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graticule::test {

/// How a command is run, where it matters.
struct RunOptions {
  std::vector<std::string> launcher;                      ///< words before it: mpirun -n 2
  std::map<std::string, std::string> environment;         ///< added to this process's own
  std::string stdout_path;                                ///< not a pipe, but this file or device
  bool terminal_stdout = false, terminal_stderr = false;  ///< on a pseudo-terminal
  std::string folder;                                     ///< working folder; "" this process's own
  std::string interrupt_at;                               ///< SIGINT as soon as stderr says this
  int signal = 0;                                         ///< sent after signal_after_s
  double signal_after_s = 0;
  std::size_t memory_bytes = 0;  ///< of address space, as `ulimit -v` has it; 0: any
  double timeout_s = 500;        ///< then it is killed, and the exit code is -1
};

/// What a command said.  From a terminal lines end in \r\n.
struct Outcome {
  int exit_code = -1;  ///< 128 + n: ended by signal n
  std::string out, err;
};

/// Runs the graticule that was built, without a shell.
Outcome RunCommand(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// A test with a folder of its own, which goes when the test ends.
class CommandTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// A path in the test's folder.
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  /// Writes a file there and returns its path.
  std::string Write(const std::string& name, const std::string& contents) const;
  /// Names of the files there, in order.
  std::vector<std::string> Files() const;

  std::filesystem::path folder_;
};

/// The same, for tests that read recorded problems: skipped without them, failed where CI=true.
class RecordedTest : public CommandTest {
 protected:
  void SetUp() override;
};

/// A recorded problem's path.
std::string Recorded(const std::string& name);

std::string ReadWhole(const std::string& path);
std::size_t CountLines(const std::string& text);

/// The outcome's stdout as JSON; the test fails, with what was said, where it is not.
nlohmann::json JsonOf(const Outcome& outcome);

/// A little pose graph with a loop, as g2o.
extern const char* const kSquare;

}  // namespace graticule::test
