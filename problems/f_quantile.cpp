#include "graticule/problems/f_quantile.hpp"

#include <cmath>

namespace graticule {
namespace {

// Regularised incomplete beta function by its continued fraction (Abramowitz and Stegun 26.5.8,
// Lentz's method), for x below (a + 1) / (a + b + 2).
double BetaShareBelow(double x, double a, double b) {
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x)) /
                       a;
  double c = 1, d = 1 / (1 - (a + b) * x / (a + 1)), fraction = d;
  for (int m = 1; m < 500; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / (1 + even * d);
    c = 1 + even / c;
    fraction *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / (1 + odd * d);
    c = 1 + odd / c;
    fraction *= c * d;
    if (std::abs(c * d - 1) < 1e-16) break;
  }
  return front * fraction;
}

double BetaShare(double x, double a, double b) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  return x < (a + 1) / (a + b + 2) ? BetaShareBelow(x, a, b) : 1 - BetaShareBelow(1 - x, b, a);
}

}  // namespace

double FExceeded(double x, double above, double below) {
  return BetaShare(below / (below + above * x), below / 2, above / 2);
}

double FQuantile(double p, double above, double below) {
  double low = 0, high = 1;  // of the beta variable above x / (above x + below)
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    (BetaShare(middle, above / 2, below / 2) < p ? low : high) = middle;
  }
  return high * below / (above * (1 - high));
}

}  // namespace graticule
