#include "fuzz.hpp"
#include "graticule/io/gnss.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  const auto fixes = ParseGnss(text, "fuzz.csv");
  if (ParseGnss(FormatGnss(fixes), "again.csv").size() != fixes.size()) std::abort();
}
