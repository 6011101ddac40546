#include "bent.hpp"

#include <stdexcept>

BENT_ENTRY { throw std::runtime_error("out of cheese"); }
