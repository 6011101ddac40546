#include "fuzz.hpp"
#include "graticule/io/toro.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const Registry types = TestRegistry();
  const Recording recording = ParseToro(text, "fuzz.graph", types);
  std::vector<std::string> notes;
  const Recording again = ParseToro(FormatToro(recording, &notes), "again.graph", types);
  if (again.graph.FactorCount() != recording.graph.FactorCount()) std::abort();
}
