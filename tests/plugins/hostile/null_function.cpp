#include "bent.hpp"

BENT_ENTRY {
  bent::factor.evaluate = nullptr;
  return &bent::plugin;
}
