#include "bent.hpp"

BENT_ENTRY {
  bent::factor.name = nullptr;
  return &bent::plugin;
}
