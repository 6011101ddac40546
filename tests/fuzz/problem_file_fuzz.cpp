#include "fuzz.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/problem_file.hpp"

// A problem of whatever format its contents are of, with the types that the program has.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const Registry types = Builtins();
  ReadOptions options;
  options.skip_unknown = text.size() % 2 == 1;
  const Recording recording = ParseProblem(text, "standard input", types, options);
  const std::string once = FormatRecording(recording);
  if (FormatRecording(ParseProblem(once, "again.fg", types, {})) != once) std::abort();
}
