#include "bent.hpp"

BENT_ENTRY {
  bent::plugin.abi_version = 2;
  return &bent::plugin;
}
