#include "bent.hpp"

// A variable type that can be moved and not compared.
BENT_ENTRY {
  static const graticule_variable_type_v1 half = {
      sizeof(graticule_variable_type_v1),           0,       "half/1", "x",    "x", "half",
      [](const double*, const double*, double*) {}, nullptr, nullptr,  nullptr};
  bent::variables[0] = &half;
  bent::plugin.variable_type_count = 1;
  return &bent::plugin;
}
