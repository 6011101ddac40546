#include "bent.hpp"

BENT_ENTRY {
  bent::plugin.variable_type_count = 1;
  return &bent::plugin;
}
