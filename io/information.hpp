#pragma once

#include <cmath>
#include <vector>

#include "graticule/solver/error.hpp"
#include "graticule/solver/noise.hpp"

namespace graticule {

/// The upper triangle, row by row, of the information matrix that a noise means: what formats know
/// that have no other kind of noise.  Throws Error where a sigma's inverse square is no finite
/// number above zero.
inline void InformationOf(NoiseView noise, int residual_size, std::vector<double>* information) {
  const auto n = static_cast<std::size_t>(residual_size);
  if (noise.kind == NoiseKind::kInformation) {
    information->assign(noise.values.begin(), noise.values.end());
    return;
  }
  information->assign(n * (n + 1) / 2, 0.0);
  for (std::size_t i = 0, at = 0; i < n; at += n - i, ++i) {
    const double sigma =
        noise.kind == NoiseKind::kUnit ? 1 : noise.values[noise.values.size() == 1 ? 0 : i];
    const double weight = 1 / (sigma * sigma);
    if (!std::isfinite(weight) || weight == 0)
      throw Error("a standard deviation is too small or too large to be written as information");
    (*information)[at] = weight;
  }
}

}  // namespace graticule
