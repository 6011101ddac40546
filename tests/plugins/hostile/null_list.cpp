#include "bent.hpp"

BENT_ENTRY {
  bent::plugin.factor_types = nullptr;
  return &bent::plugin;
}
