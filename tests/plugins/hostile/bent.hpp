#pragma once

// A plug-in written by hand against the C table, good as it stands: x is measured directly.  Each
// file beside this one bends one thing.  Without the SDK, which would catch most of it.

#include <graticule/solver/plugin_abi.h>

#include <cstdio>

namespace bent {

inline void* Create(const graticule_measurement* measurement, int32_t, int32_t* residual_count,
                    graticule_error*) {
  *residual_count = 1;
  return new double(measurement->values[0]);
}

inline int32_t Evaluate(const void* self, const double* const* blocks, double* residual,
                        double** jacobians, graticule_error*) {
  residual[0] = blocks[0][0] - *static_cast<const double*>(self);
  if (jacobians && jacobians[0]) jacobians[0][0] = 1;
  return 1;
}

inline void Destroy(void* self) { delete static_cast<double*>(self); }

/// To be changed before the entry returns.
inline graticule_factor_type_v1 factor = {sizeof(graticule_factor_type_v1),
                                          0,
                                          "bent/1",
                                          "x:vector1/1 | x",
                                          "bent",
                                          Create,
                                          Evaluate,
                                          Destroy};
inline const graticule_factor_type_v1* factors[] = {&factor};
inline const graticule_variable_type_v1* variables[] = {nullptr};
inline graticule_plugin_v1 plugin = {sizeof(graticule_plugin_v1),
                                     GRATICULE_ABI_VERSION,
                                     "bent",
                                     "1.0.0",
                                     "MIT",
                                     1,
                                     0,
                                     factors,
                                     variables};

}  // namespace bent

#define BENT_ENTRY                                                             \
  extern "C" __attribute__((visibility("default"))) const graticule_plugin_v1* \
  graticule_plugin_entry_v1()
