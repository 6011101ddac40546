#include "fuzz.hpp"
#include "graticule/problems/calibration/target.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  const Target target = ParseTarget(text, "fuzz.yaml");
  const std::string once = FormatTarget(target);
  if (FormatTarget(ParseTarget(once, "again.yaml")) != once) std::abort();
  CornersOf(target);
}
