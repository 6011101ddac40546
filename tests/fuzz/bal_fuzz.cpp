#include "fuzz.hpp"
#include "graticule/io/bal.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const Registry types = TestRegistry();
  const Recording recording = ParseBal(text, "fuzz.bal", types);
  std::vector<std::string> notes;
  const Recording again = ParseBal(FormatBal(recording, &notes), "again.bal", types);
  if (again.graph.FactorCount() != recording.graph.FactorCount()) std::abort();
}
