#include "fuzz.hpp"
#include "graticule/io/carmen.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  CarmenOptions options;
  options.skip_bad = !text.empty() && text[0] == '#';
  LaserLog log, again;
  ParseCarmen(text, "fuzz.clf", options, &log);
  if (ParseCarmen(FormatCarmen(log), "again.clf", options, &again).scans != log.scans.size())
    std::abort();
}
