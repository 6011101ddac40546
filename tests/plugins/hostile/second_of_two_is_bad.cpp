#include "bent.hpp"

// The first factor is good; nothing of the plug-in may stay.
BENT_ENTRY {
  static graticule_factor_type_v1 bad = bent::factor;
  bad.name = "no version";
  static const graticule_factor_type_v1* both[] = {&bent::factor, &bad};
  bent::plugin.factor_types = both;
  bent::plugin.factor_type_count = 2;
  return &bent::plugin;
}
