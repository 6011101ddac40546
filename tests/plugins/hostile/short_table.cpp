#include "bent.hpp"

BENT_ENTRY {
  bent::factor.size = 40;
  return &bent::plugin;
}
