#pragma once

#include <vector>

#include "graticule/solver/noise.hpp"

namespace graticule {

/// The upper triangle, row by row, of the information matrix that a noise means: what formats know
/// that have no other kind of noise.
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
    (*information)[at] = 1 / (sigma * sigma);
  }
}

}  // namespace graticule
