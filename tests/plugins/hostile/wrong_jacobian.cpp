#include "bent.hpp"

// Of two blocks of two, one derivative has the wrong sign: the second residual by the second number
// of b.
BENT_ENTRY {
  bent::factor.schema = "a:point2/1 b:point2/1 | x:m y:m";
  bent::factor.create = [](const graticule_measurement* measurement, int32_t, int32_t* residuals,
                           graticule_error*) -> void* {
    *residuals = 2;
    return new double(measurement->values[0]);
  };
  bent::factor.evaluate = [](const void* self, const double* const* blocks, double* residual,
                             double** jacobians, graticule_error*) -> int32_t {
    for (int i = 0; i < 2; ++i)
      residual[i] = blocks[1][i] - blocks[0][i] - *static_cast<const double*>(self);
    if (!jacobians) return 1;
    const double a[4] = {-1, 0, 0, -1}, b[4] = {1, 0, 0, -1};
    for (int i = 0; i < 4; ++i) {
      if (jacobians[0]) jacobians[0][i] = a[i];
      if (jacobians[1]) jacobians[1][i] = b[i];
    }
    return 1;
  };
  return &bent::plugin;
}
