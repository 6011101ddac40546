#include "fuzz.hpp"
#include "graticule/io/correspondences.hpp"

// Boards' planes where the first byte is not one that a number has, points else.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  if (!text.empty() && text[0] >= 'a') {
    ParsePlanes(text, "planes.csv");
    return;
  }
  const std::string once = FormatCorrespondences(ParseCorrespondences(text, "fuzz.csv"));
  if (FormatCorrespondences(ParseCorrespondences(once, "again.csv")) != once) std::abort();
}
