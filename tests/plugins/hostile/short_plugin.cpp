#include "bent.hpp"

BENT_ENTRY {
  bent::plugin.size = 16;
  return &bent::plugin;
}
