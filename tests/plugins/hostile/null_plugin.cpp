#include "bent.hpp"

BENT_ENTRY { return nullptr; }
