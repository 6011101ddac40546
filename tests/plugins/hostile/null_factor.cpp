#include "bent.hpp"

BENT_ENTRY {
  bent::factors[0] = nullptr;
  return &bent::plugin;
}
