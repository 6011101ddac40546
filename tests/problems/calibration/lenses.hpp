#pragma once

#include <vector>

#include "graticule/io/camera_file.hpp"

namespace graticule::testing {

/// A camera of every model, with terms as lenses have them.
inline std::vector<CameraIntrinsics> Lenses() {
  const auto camera = [](const char* model, double f, std::vector<double> terms) {
    std::vector<double> parameters = {f, f * 1.01, 322, 238};
    parameters.insert(parameters.end(), terms.begin(), terms.end());
    return CameraIntrinsics{"cam0", model, 640, 480, parameters};
  };
  return {camera("pinhole", 530, {}),
          camera("radial2", 400, {-.28, .07}),
          camera("radial3", 400, {-.28, .09, -.012}),
          camera("brown4", 400, {-.28, .07, .001, -.002}),
          camera("brown5", 400, {-.28, .09, .001, -.002, -.012}),
          camera("brown8", 400, {.5, .1, .001, -.002, .01, .8, .3, .05}),
          camera("angular1", 300, {-.02}),
          camera("angular2", 300, {-.02, .004}),
          camera("angular3", 300, {-.02, .004, -.001}),
          camera("angular4", 190, {.01, -.01, .006, -.0017}),
          camera("angular5", 190, {.01, -.01, .006, -.0017, .0001}),
          camera("angular6", 190, {.01, -.01, .006, -.0017, .0001, .00001}),
          camera("unified", 400, {.55}),
          camera("extended_unified", 300, {.6, 1.1}),
          camera("double_sphere", 250, {-.2, .59})};
}

}  // namespace graticule::testing
