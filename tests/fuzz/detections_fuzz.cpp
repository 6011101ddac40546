#include "fuzz.hpp"
#include "graticule/io/detections.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  const Detections detections = ParseDetections(text, "fuzz.json");
  const std::string once = FormatDetections(detections);
  if (FormatDetections(ParseDetections(once, "again.json")) != once) std::abort();
}
