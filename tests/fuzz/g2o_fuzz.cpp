#include "fuzz.hpp"
#include "graticule/io/g2o.hpp"

// What was read can be written, and is read back alike.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const Registry types = TestRegistry();
  ReadOptions options;
  options.skip_unknown = !text.empty() && text[0] == 'S';
  options.repair_information = text.size() % 2 == 1;
  const Recording recording = ParseG2o(text, "fuzz.g2o", types, options);
  std::vector<std::string> notes;
  const Recording again = ParseG2o(FormatG2o(recording, &notes), "again.g2o", types);
  if (again.graph.FactorCount() != recording.graph.FactorCount()) std::abort();
}
