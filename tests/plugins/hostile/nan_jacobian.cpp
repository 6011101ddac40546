#include "bent.hpp"

#include <cmath>

BENT_ENTRY {
  bent::factor.evaluate = [](const void* self, const double* const* blocks, double* residual,
                             double** jacobians, graticule_error* error) -> int32_t {
    bent::Evaluate(self, blocks, residual, nullptr, error);
    if (jacobians && jacobians[0]) jacobians[0][0] = std::nan("");
    return 1;
  };
  return &bent::plugin;
}
