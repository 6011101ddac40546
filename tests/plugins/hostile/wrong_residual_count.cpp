#include "bent.hpp"

BENT_ENTRY {
  bent::factor.create = [](const graticule_measurement* measurement, int32_t, int32_t* residuals,
                           graticule_error*) -> void* {
    *residuals = 1000;
    return new double(measurement->values[0]);
  };
  return &bent::plugin;
}
