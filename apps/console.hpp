#pragma once

#include <string>

#include "graticule/solver/error.hpp"
#include "graticule/solver/report.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule::apps {

/// Exit codes, as docs/command.md lists them.
enum Exit {
  kDone = 0,
  kOtherFailure = 1,
  kUsage = 2,
  kInputRefused = 3,
  kNotConverged = 4,
  kIllPosed = 5,
  kTypeMissing = 6,
  kInternal = 70,
};

Exit ExitOf(ErrorKind kind);
Exit ExitOf(Termination termination);

/// What every command knows about its terminal.  Of the processes that a launcher started together
/// only the first has one: the others print nothing.
struct Console {
  bool quiet = false;

  /// Colour on stdout: only on a terminal, and never with NO_COLOR.
  bool Colour() const;
  /// A line on stderr: "graticule: ...".  Errors are printed even where quiet.
  void Error(const std::string& text) const;
  void Note(const std::string& text) const;
  /// Replaces the progress line on stderr; nothing where stderr is not a terminal or quiet.  ""
  /// removes it.
  void Progress(const std::string& text) const;
};

/// While it lives, Ctrl-C and SIGTERM ask the solve to end with the best values so far; a second
/// one kills.
class Interruptible {
 public:
  Interruptible();
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  static bool WasAsked();
  /// As if a signal had come.
  static void Ask();
};

/// An observer that shows iterations on the progress line and minds Ctrl-C.
Observer Watch(const Console& console, const std::string& what);

/// Largest resident memory of the process since its start or the last reset, in bytes.
std::uint64_t PeakMemory();
/// Starts counting anew where the system can (Linux).
void ResetPeakMemory();

/// "1.23 ms", "45.6 s".
std::string Seconds(double seconds);

}  // namespace graticule::apps
