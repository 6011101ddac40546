// A lens of one's own: docs/plugins.md, "A lens".

#include <cmath>
#include <graticule/factors/lens_sdk.hpp>

namespace {

/// Division model (Fitzgibbon, CVPR 2001): a bent point b and the straight one q = (x, y) / z are
/// one ray, q = b / (1 + lambda |b|^2).  Solved for b: 2 (x, y) / (z + d), d^2 = z^2 - 4 lambda
/// (x^2 + y^2).  With lambda < 0 it sees behind itself; -1/4 is the stereographic lens.
struct DivisionLens {
  static constexpr const char* kName = "division";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px lambda";
  static constexpr int kTerms = 1;
  static constexpr bool kSeesBehind = true;
  static constexpr double kStart[] = {-0.25};

  static bool Bend(const double* terms, const double* point, double* bent, double* by_point,
                   double* by_terms) {
    const double lambda = terms[0], x = point[0], y = point[1], z = point[2];
    const double across = x * x + y * y, d_squared = z * z - 4 * lambda * across;
    if (!(d_squared > 0)) return false;
    const double d = std::sqrt(d_squared), n = z + d;
    if (!(n > 1e-9 * d)) return false;
    bent[0] = 2 * x / n;
    bent[1] = 2 * y / n;
    if (by_point) {
      const double by_n[3] = {-4 * lambda * x / d, -4 * lambda * y / d, 1 + z / d};
      for (int row = 0; row < 2; ++row)
        for (int i = 0; i < 3; ++i)
          by_point[3 * row + i] = ((row == i ? 2 : 0) - bent[row] * by_n[i]) / n;
    }
    if (by_terms)
      for (int row = 0; row < 2; ++row) by_terms[row] = bent[row] * 2 * across / (d * n);
    return true;
  }
};

}  // namespace

GRATICULE_LENS_PLUGIN("division", "1.0.0", "BSD-3-Clause", DivisionLens)
