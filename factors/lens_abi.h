/* What a plug-in says of its lenses beside their variable and factor types (solver/plugin_abi.h):
 * C, frozen as that is.  Authors do not use this header directly: factors/lens_sdk.hpp writes it.
 */
#ifndef GRATICULE_FACTORS_LENS_ABI_H_
#define GRATICULE_FACTORS_LENS_ABI_H_

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GRATICULE_LENSES_ENTRY "graticule_lenses_entry_v1"

/* The model has images of points with z <= 0. */
#define GRATICULE_LENS_SEES_BEHIND 1u

typedef struct graticule_lens_v1 {
  uint32_t size; /* sizeof this struct as the plug-in was compiled */
  uint32_t flags;
  const char* name;    /* "division"; the plug-in has camera_division/1 and its four factors */
  const char* fields;  /* of camera_division/1: fx fy cx cy, then the lens' terms */
  int32_t parameters;  /* how many */
  const double* start; /* the terms to begin a fit from; null: zeros */
  /* Pixel of a point in the camera's frame, with row-major derivatives or null, as
   * CameraModel::project (factors/camera_model.hpp).  Thread-safe, never throws. */
  bool (*project)(const double* parameters, const double* point_in_camera, double* pixel,
                  double* by_point, double* by_parameters);
} graticule_lens_v1;

typedef struct graticule_lenses_v1 {
  uint32_t size;
  int32_t lens_count;
  const graticule_lens_v1* const* lenses;
} graticule_lenses_v1;

/* The second exported symbol of a plug-in that has lenses.  Everything it points to lives for
 * ever. */
typedef const graticule_lenses_v1* (*graticule_lenses_entry)(void);

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* GRATICULE_FACTORS_LENS_ABI_H_ */
