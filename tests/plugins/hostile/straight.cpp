#include "bent.hpp"

BENT_ENTRY { return &bent::plugin; }
