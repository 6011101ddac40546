#include "bent.hpp"

BENT_ENTRY {
  bent::plugin.factor_type_count = -1;
  return &bent::plugin;
}
