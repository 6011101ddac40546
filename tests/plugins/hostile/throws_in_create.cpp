#include "bent.hpp"

#include <stdexcept>

BENT_ENTRY {
  bent::factor.create = [](const graticule_measurement*, int32_t, int32_t*,
                           graticule_error*) -> void* {
    throw std::runtime_error("out of cheese");
  };
  return &bent::plugin;
}
