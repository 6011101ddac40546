#include "bent.hpp"

#include <cstring>

// Fails with a message that has no end.
BENT_ENTRY {
  bent::factor.evaluate = [](const void*, const double* const*, double*, double**,
                             graticule_error* error) -> int32_t {
    std::memset(error->message, 'x', sizeof(error->message));
    return 0;
  };
  return &bent::plugin;
}
