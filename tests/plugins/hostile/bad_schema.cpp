#include "bent.hpp"

BENT_ENTRY {
  bent::factor.schema = "x:vector1 | x";
  return &bent::plugin;
}
