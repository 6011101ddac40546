#include "fuzz.hpp"
#include "graticule/io/recording.hpp"

// What was read is the same problem as text and as binary.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const Registry types = TestRegistry();
  ReadOptions options;
  options.repair_information = text.size() % 2 == 1;
  const Recording recording = ParseRecording(text, "fuzz.fg", types, options);
  const std::string written = FormatRecording(recording);
  const std::string binary = FormatRecording(ParseRecording(written, "again.fg", types), true);
  if (FormatRecording(ParseRecording(binary, "binary.fg", types)) != written) std::abort();
}
