#include "console.hpp"

#include <fmt/core.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "launcher.hpp"

namespace graticule::apps {
namespace {

volatile sig_atomic_t interrupted = 0;
// By the program itself: the first signal after it does not kill.
std::atomic<bool> asked{false};
struct sigaction previous_interrupt, previous_terminate;

void OnSignal(int number) {
  if (interrupted) {
    signal(number, SIG_DFL);
    raise(number);
  }
  interrupted = 1;
}

bool StderrIsTerminal() { return isatty(STDERR_FILENO) == 1; }

}  // namespace

Exit ExitOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return kUsage;
    case ErrorKind::kInput:
      return kInputRefused;
    case ErrorKind::kIllPosed:
      return kIllPosed;
    case ErrorKind::kMissingType:
      return kTypeMissing;
    case ErrorKind::kOther:
      break;
  }
  return kOtherFailure;
}

Exit ExitOf(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return kDone;
    case Termination::kFailed:
      return kOtherFailure;
    default:
      return kNotConverged;
  }
}

bool Console::Colour() const {
  const char* no_color = std::getenv("NO_COLOR");
  if (LaunchedAs().size > 1) return false;  // a launcher's own terminal, whatever comes behind it
  return isatty(STDOUT_FILENO) == 1 && !(no_color && *no_color);
}

void Console::Error(const std::string& text) const {
  if (LaunchedAs().rank > 0) return;
  Progress("");
  fmt::print(stderr, "graticule: {}\n", text);
}

void Console::Note(const std::string& text) const {
  if (quiet || LaunchedAs().rank > 0) return;
  Progress("");
  fmt::print(stderr, "graticule: {}\n", text);
}

void Console::Progress(const std::string& text) const {
  if (quiet || !StderrIsTerminal() || LaunchedAs().rank > 0) return;
  fmt::print(stderr, "\r\033[K{}", text);
  std::fflush(stderr);
}

Interruptible::Interruptible() {
  interrupted = 0;
  asked = false;
  struct sigaction action {};
  action.sa_handler = OnSignal;
  sigaction(SIGINT, &action, &previous_interrupt);
  sigaction(SIGTERM, &action, &previous_terminate);
}

Interruptible::~Interruptible() {
  sigaction(SIGINT, &previous_interrupt, nullptr);
  sigaction(SIGTERM, &previous_terminate, nullptr);
}

bool Interruptible::WasAsked() { return interrupted != 0 || asked; }

void Interruptible::Ask() { asked = true; }

Observer Watch(const Console& console, const std::string& what) {
  Observer observer;
  observer.on_iteration = [&console, what](const Iteration& row) {
    // Not known while a start is looked for.
    const std::string objective =
        std::isnan(row.objective) ? "" : fmt::format(", objective {:.9g}", row.objective);
    console.Progress(
        fmt::format("{}: iteration {}{}, {}", what, row.number, objective, Seconds(row.seconds)));
    return !Interruptible::WasAsked();
  };
  return observer;
}

std::uint64_t PeakMemory() {
  // VmHWM, not getrusage: only that can be reset, and a child does not inherit it from a shell.
  std::uint64_t kilobytes = 0;
  if (std::FILE* status = std::fopen("/proc/self/status", "r")) {
    char line[256];
    while (std::fgets(line, sizeof(line), status))
      if (std::strncmp(line, "VmHWM:", 6) == 0) kilobytes = std::strtoull(line + 6, nullptr, 10);
    std::fclose(status);
  }
  if (kilobytes == 0) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    kilobytes = static_cast<std::uint64_t>(usage.ru_maxrss);
  }
  return kilobytes * 1024;
}

void ResetPeakMemory() {
  if (std::FILE* file = std::fopen("/proc/self/clear_refs", "w")) {
    std::fputs("5", file);
    std::fclose(file);
  }
}

std::string Seconds(double seconds) {
  if (seconds < 0.9995e-3) return fmt::format("{:.0f} us", seconds * 1e6);
  if (seconds < 0.9995) return fmt::format("{:.3g} ms", seconds * 1e3);
  return fmt::format("{:.2f} s", seconds);
}

}  // namespace graticule::apps
