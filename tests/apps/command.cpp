#include "command.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace graticule::test {
namespace {

namespace fs = std::filesystem;

// One of the child's output streams, as both sides see it.
struct Stream {
  int ours = -1, childs = -1;
  std::string text;

  void Open(bool terminal) {
    int ends[2] = {-1, -1};
    const int failed =
        terminal ? openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) : pipe2(ends, O_CLOEXEC);
    if (failed != 0) throw std::runtime_error("no pipe or terminal");
    ours = ends[0];
    childs = ends[1];
    fcntl(ours, F_SETFD, FD_CLOEXEC);
  }
  // False at the end.  A terminal whose other side has gone says EIO.
  bool Read() {
    char buffer[1 << 16];
    const ssize_t got = read(ours, buffer, sizeof(buffer));
    if (got < 0 && errno == EINTR) return true;
    if (got <= 0) return false;
    text.append(buffer, static_cast<std::size_t>(got));
    return true;
  }
};

[[noreturn]] void RunChild(const std::vector<std::string>& arguments, const RunOptions& options,
                           int out, int err) {
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  for (const char* name : {"NO_COLOR", "GRATICULE_PLUGIN_PATH", "GRATICULE_CONFIG_PATH"})
    unsetenv(name);
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(126);
  std::vector<char*> words;
  for (const std::string& word : options.launcher) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(const_cast<char*>(words.empty() ? "graticule" : GRATICULE_PROGRAM));
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  if (options.memory_bytes) {
    const rlimit limit = {options.memory_bytes, options.memory_bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  execvp(options.launcher.empty() ? GRATICULE_PROGRAM : words[0], words.data());
  _exit(127);
}

}  // namespace

Outcome RunCommand(const std::vector<std::string>& arguments, const RunOptions& options) {
  Stream out, err;
  if (options.stdout_path.empty()) {
    out.Open(options.terminal_stdout);
  } else {
    out.childs = open(options.stdout_path.c_str(), O_WRONLY | O_CLOEXEC);
    if (out.childs < 0) throw std::runtime_error("cannot open " + options.stdout_path);
  }
  err.Open(options.terminal_stderr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) RunChild(arguments, options, out.childs, err.childs);
  close(out.childs);
  close(err.childs);

  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto end = start + std::chrono::duration<double>(options.timeout_s);
  const auto signal_at = start + std::chrono::duration<double>(options.signal_after_s);
  bool interrupted = options.interrupt_at.empty(), signalled = options.signal == 0,
       timed_out = false;
  pollfd watched[] = {{out.ours, POLLIN, 0}, {err.ours, POLLIN, 0}};
  while (watched[0].fd >= 0 || watched[1].fd >= 0) {
    poll(watched, 2, signalled ? 100 : 1);
    if (!signalled && Clock::now() >= signal_at) {
      kill(child, options.signal);
      signalled = true;
    }
    if (watched[0].revents && !out.Read()) watched[0].fd = -1;
    if (watched[1].revents && !err.Read()) watched[1].fd = -1;
    if (!interrupted && err.text.find(options.interrupt_at) != std::string::npos) {
      kill(child, SIGINT);
      interrupted = true;
    }
    if (!timed_out && Clock::now() > end) {
      kill(child, SIGKILL);
      timed_out = true;
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (out.ours >= 0) close(out.ours);
  close(err.ours);
  Outcome outcome;
  if (!timed_out)
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = out.text;
  outcome.err = err.text;
  return outcome;
}

void CommandTest::SetUp() {
  std::string name = (fs::temp_directory_path() / "graticule-apps-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  folder_ = name;
}

void CommandTest::TearDown() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

std::string CommandTest::Write(const std::string& name, const std::string& contents) const {
  std::ofstream(Path(name), std::ios::binary) << contents;
  return Path(name);
}

std::vector<std::string> CommandTest::Files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void RecordedTest::SetUp() {
  CommandTest::SetUp();
  if (fs::is_regular_file(Recorded("intel.g2o"))) return;
  const char* ci = std::getenv("CI");
  const std::string missing = "no recorded problems in " GRATICULE_DATA_DIR
                              "/posegraph; set GRATICULE_DATA_DIR when configuring";
  if (ci && std::string(ci) == "true") FAIL() << missing;
  GTEST_SKIP() << missing;
}

std::string Recorded(const std::string& name) {
  return std::string(GRATICULE_DATA_DIR "/posegraph/") + name;
}

std::string ReadWhole(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::size_t CountLines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

nlohmann::json JsonOf(const Outcome& outcome) {
  nlohmann::json json = nlohmann::json::parse(outcome.out, nullptr, false);
  if (!json.is_discarded()) return json;
  ADD_FAILURE() << "exit " << outcome.exit_code << ", not JSON: " << outcome.out.substr(0, 500)
                << "\nstderr: " << outcome.err.substr(0, 500);
  return nlohmann::json::object();
}

const char* const kSquare = R"(VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1.1 0.1 1.5
VERTEX_SE2 2 1 1 3.1
VERTEX_SE2 3 0.1 0.9 -1.6
EDGE_SE2 0 1 1 0 1.57 100 0 0 100 0 400
EDGE_SE2 1 2 1 0 1.57 100 0 0 100 0 400
EDGE_SE2 2 3 1 0 1.57 100 0 0 100 0 400
EDGE_SE2 3 0 1 0 1.57 100 0 0 100 0 400
)";

}  // namespace graticule::test
