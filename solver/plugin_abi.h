/* The boundary between Graticule and a plug-in: C, so that compiler, flags and Eigen may differ on
 * the two sides.  Frozen: later versions only append members, and `size` tells which are there.
 * Built-in types come through the same tables.  Authors do not use this header directly:
 * factors/sdk.hpp writes the tables. */
#ifndef GRATICULE_SOLVER_PLUGIN_ABI_H_
#define GRATICULE_SOLVER_PLUGIN_ABI_H_

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GRATICULE_ABI_VERSION 1
#define GRATICULE_PLUGIN_ENTRY "graticule_plugin_entry_v1"

/* Where a callee writes why it returned failure; always ends in a zero. */
typedef struct graticule_error {
  char message[512];
} graticule_error;

/* What was measured: `values` as the schema lays them out, borrowed for the call only. */
typedef struct graticule_measurement {
  uint32_t size; /* sizeof this struct */
  int32_t value_count;
  const double* values;
} graticule_measurement;

/* A variable type.  Vectors of R^n need no functions: leave plus .. normalise null.
 * All matrices are row-major.  `plus` may not alias its arguments. */
typedef struct graticule_variable_type_v1 {
  uint32_t size;       /* sizeof this struct as the plug-in was compiled */
  uint32_t flags;      /* none yet: 0 */
  const char* name;    /* "se2/1" */
  const char* fields;  /* "x:m y:m yaw:rad": the numbers stored */
  const char* tangent; /* "x:m y:m yaw:rad": the numbers of a small change, applied on the right */
  const char* summary; /* one line for help */
  void (*plus)(const double* x, const double* delta, double* x_plus_delta);
  void (*plus_jacobian)(const double* x, double* jacobian); /* fields x tangent, at delta = 0 */
  void (*minus)(const double* y, const double* x, double* y_minus_x);
  /* Brings a stored value onto the manifold (unit quaternion); returns 0 if it is too far off to be
   * meant. */
  int32_t (*normalise)(double* x);
} graticule_variable_type_v1;

/* The residual depends on its variables' relative placement only, not on where the map's frame is:
 * a graph with nothing but such factors has a free gauge, which the solver anchors. */
#define GRATICULE_FACTOR_RELATIVE 1u
/* `evaluate` writes Jacobians with respect to the tangent (rows x tangent size) instead of the
 * stored fields. */
#define GRATICULE_FACTOR_TANGENT_JACOBIANS 2u

typedef struct graticule_factor_type_v1 {
  uint32_t size;       /* sizeof this struct as the plug-in was compiled */
  uint32_t flags;      /* GRATICULE_FACTOR_... */
  const char* name;    /* "between_se2/1" */
  const char* schema;  /* "a:se2/1 b:se2/1 | x:m y:m yaw:rad": see solver/schema.hpp */
  const char* summary; /* one line for help */
  /* One object a factor.  Null on failure, with a message in `error`. */
  void* (*create)(const graticule_measurement* measurement, int32_t block_count,
                  int32_t* residual_count, graticule_error* error);
  /* Raw residual in the schema's units; `jacobians` is null, or holds for each block null or
   * residual_count x block size numbers, row-major.  Returns 0 on failure.  Thread-safe, never
   * throws. */
  int32_t (*evaluate)(const void* self, const double* const* blocks, double* residual,
                      double** jacobians, graticule_error* error);
  void (*destroy)(void* self);
} graticule_factor_type_v1;

typedef struct graticule_plugin_v1 {
  uint32_t size;        /* sizeof this struct */
  uint32_t abi_version; /* GRATICULE_ABI_VERSION */
  const char* name;
  const char* version;
  const char* licence;
  int32_t factor_type_count;
  int32_t variable_type_count;
  const graticule_factor_type_v1* const* factor_types;
  const graticule_variable_type_v1* const* variable_types;
} graticule_plugin_v1;

/* The one exported symbol, with the name GRATICULE_PLUGIN_ENTRY.  Everything it points to lives for
 * ever. */
typedef const graticule_plugin_v1* (*graticule_plugin_entry)(void);

#ifdef __cplusplus
} /* extern "C" */

#include <cstddef>
/* The layout of version 1, on every platform with 8-byte pointers. */
static_assert(sizeof(void*) != 8 || sizeof(graticule_measurement) == 16, "frozen");
static_assert(sizeof(void*) != 8 || offsetof(graticule_measurement, values) == 8, "frozen");
static_assert(sizeof(void*) != 8 || sizeof(graticule_variable_type_v1) == 72, "frozen");
static_assert(sizeof(void*) != 8 || offsetof(graticule_variable_type_v1, plus) == 40, "frozen");
static_assert(sizeof(void*) != 8 || offsetof(graticule_variable_type_v1, normalise) == 64,
              "frozen");
static_assert(sizeof(void*) != 8 || sizeof(graticule_factor_type_v1) == 56, "frozen");
static_assert(sizeof(void*) != 8 || offsetof(graticule_factor_type_v1, create) == 32, "frozen");
static_assert(sizeof(void*) != 8 || offsetof(graticule_factor_type_v1, destroy) == 48, "frozen");
static_assert(sizeof(void*) != 8 || sizeof(graticule_plugin_v1) == 56, "frozen");
static_assert(sizeof(void*) != 8 || offsetof(graticule_plugin_v1, factor_types) == 40, "frozen");
static_assert(sizeof(graticule_error) == 512, "frozen");
#endif

#endif /* GRATICULE_SOLVER_PLUGIN_ABI_H_ */
