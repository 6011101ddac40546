#include "fuzz.hpp"
#include "graticule/io/mission_index.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  const std::string once = FormatMissionIndex(ParseMissionIndex(text, "mission.index"));
  if (FormatMissionIndex(ParseMissionIndex(once, "again.index")) != once) std::abort();
}
