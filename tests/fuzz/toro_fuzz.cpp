#include "fuzz.hpp"
#include "graticule/io/toro.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const Registry types = TestRegistry();
  ReadOptions options;
  options.repair_information = text.size() % 2 == 1;
  const Recording recording = ParseToro(text, "fuzz.graph", types, options);
  std::vector<std::string> notes;
  const Recording again = ParseToro(FormatToro(recording, &notes), "again.graph", types);
  if (again.graph.FactorCount() != recording.graph.FactorCount()) std::abort();
}
