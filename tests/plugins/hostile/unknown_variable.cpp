#include "bent.hpp"

BENT_ENTRY {
  bent::factor.schema = "x:klein_bottle/1 | x";
  return &bent::plugin;
}
