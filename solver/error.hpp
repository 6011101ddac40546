#pragma once

#include <cstddef>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace graticule {

/// What kind of thing went wrong; the command maps each kind to one exit code (docs/command.md).
enum class ErrorKind {
  kOther,        ///< none of the below, e.g. a full disk; exit 1
  kUsage,        ///< an option or argument that does not exist or does not fit; exit 2
  kInput,        ///< an input was refused; exit 3
  kIllPosed,     ///< the question has no single answer (loose variables, several pieces); exit 5
  kMissingType,  ///< a factor type, variable type or plug-in is missing or refused; exit 6
};

/// A wrong input: file, key, option, plug-in.  The text is one line that says where, what was
/// found, what was expected.  Numerical outcomes (no convergence) are never thrown: they are in the
/// Report.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ErrorKind kind = ErrorKind::kInput)
      : std::runtime_error(message), kind_(kind) {}

  /// An error at a place in a file: "file:line:column: message".  Lines and columns count from 1,
  /// in bytes; column 0 leaves the column out, line 0 leaves both out.
  Error(const std::string& file, std::size_t line, std::size_t column, const std::string& message,
        ErrorKind kind = ErrorKind::kInput)
      : Error(file + (line ? ":" + std::to_string(line) : "") +
                  (line && column ? ":" + std::to_string(column) : "") + ": " + message,
              kind) {}

  ErrorKind Kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// A number as messages show it: "1e-09", not "0.000000".
inline std::string Shown(double number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", number);
  return text;
}

}  // namespace graticule
