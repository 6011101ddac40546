#include "graticule/problems/chi_square.hpp"

#include <cmath>

namespace graticule {

// Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 6.5.29 (the series) and 6.5.31
// (the continued fraction, evaluated by Lentz's method): each where it converges quickly.
double ChiSquareShare(double x, double degrees) {
  if (!(x > 0)) return 0;
  const double a = degrees / 2, z = x / 2;
  const double scale = std::exp(a * std::log(z) - z - std::lgamma(a));
  if (z < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; term > 1e-17 * sum; ++n) sum += term *= z / n;
    return scale * sum;
  }
  double b = z + 1 - a, c = 1e300, d = 1 / b, fraction = d;
  for (int n = 1; n < 1000; ++n) {
    const double numerator = n * (a - n);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    fraction *= c * d;
    if (std::abs(c * d - 1) < 1e-16) break;
  }
  return 1 - scale * fraction;
}

double ChiSquareQuantile(double p, double degrees) {
  double low = 0, high = degrees;
  while (ChiSquareShare(high, degrees) < p) low = high, high *= 2;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return high;
    (ChiSquareShare(middle, degrees) < p ? low : high) = middle;
  }
}

}  // namespace graticule
