#include "fuzz.hpp"
#include "graticule/io/signal_pairs.hpp"

// Links to predict over, or, where the first column is an id, where radios stand.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  if (text.substr(0, 2) == "id") {
    ParseAnchors(text, "anchors.csv");
    return;
  }
  const SignalLog log = ParseSignalPairs(text, "fuzz.csv");
  for (const SignalMeasurement& pair : log.measurements)
    if (pair.link.receiver >= log.radios.size() || pair.link.transmitter >= log.radios.size())
      std::abort();
}
