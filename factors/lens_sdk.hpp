#pragma once

// clang-format off
// The only header that the author of a lens needs (docs/plugins.md, "A lens", is the guide).
//
//   struct DivisionLens {
//     static constexpr const char* kName = "division";
//     static constexpr const char* kFields = "fx:px fy:px cx:px cy:px lambda";
//     static constexpr int kTerms = 1;                   // beside fx fy cx cy
//     static constexpr bool kSeesBehind = true;          // optional: images of points with z <= 0
//     static constexpr double kStart[] = {-0.25};        // optional: terms that a fit begins from
//     static bool Bend(const double* terms, const double* point, double* bent,
//                      double* by_point, double* by_terms);
//   };
//   GRATICULE_LENS_PLUGIN("division", "1.0.0", "MIT", DivisionLens)
//
// Bend is lens.hpp's: a point in the camera's frame to the plane at focal length 1, with row-major derivatives
// or null.  The variable, the factors and the camera model are made from it.
// clang-format on

#include "graticule/factors/lens_abi.h"
#include "graticule/factors/registration.hpp"
#include "graticule/factors/reprojection.hpp"

#pragma GCC visibility push(hidden)
namespace graticule::sdk {

/// What a lens is beside its types.
template <class Lens>
struct LensTable {
  static bool Project(const double* parameters, const double* point_in_camera, double* pixel,
                      double* by_point, double* by_parameters) {
    try {
      return ProjectThrough<Lens>(parameters, point_in_camera, pixel, by_point, by_parameters);
    } catch (...) {
      return false;
    }
  }

  static constexpr graticule_lens_v1 kTable = {
      sizeof(graticule_lens_v1),
      lens::SeesBehind<Lens>::value ? GRATICULE_LENS_SEES_BEHIND : 0u,
      Lens::kName,
      Lens::kFields,
      4 + Lens::kTerms,
      lens::Start<Lens>::kTerms,
      Project};
};

template <class... Lenses>
const graticule_plugin_v1* LensPlugin(const char* name, const char* version, const char* licence) {
  return Plugin<CameraVariable<Lenses>..., Reprojection<Lenses>..., CornerReprojection<Lenses>...,
                PriorCamera<Lenses>..., PointReprojection<Lenses>...>(name, version, licence);
}

template <class... Lenses>
const graticule_lenses_v1* LensesOf() {
  static const graticule_lens_v1* const lenses[] = {&LensTable<Lenses>::kTable...};
  static const graticule_lenses_v1 table = {sizeof(graticule_lenses_v1),
                                            static_cast<int32_t>(sizeof...(Lenses)), lenses};
  return &table;
}

}  // namespace graticule::sdk
#pragma GCC visibility pop

/// The one line that makes a shared library a plug-in of lenses: name, version, licence, structs.
#define GRATICULE_LENS_PLUGIN(name, version, licence, ...)                     \
  extern "C" __attribute__((visibility("default"))) const graticule_plugin_v1* \
  graticule_plugin_entry_v1() {                                                \
    return graticule::sdk::LensPlugin<__VA_ARGS__>(name, version, licence);    \
  }                                                                            \
  extern "C" __attribute__((visibility("default"))) const graticule_lenses_v1* \
  graticule_lenses_entry_v1() {                                                \
    return graticule::sdk::LensesOf<__VA_ARGS__>();                            \
  }
