#include "bent.hpp"

BENT_ENTRY {
  bent::factor.name = "between_se2/1";
  return &bent::plugin;
}
