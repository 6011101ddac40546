#pragma once

#include <cmath>

namespace graticule {

/// -log Phi(z), Phi the normal distribution function: exact to a few last digits for every z.
inline double MinusLogNormalCdf(double z) {
  if (z > 0) return -std::log1p(-0.5 * std::erfc(z * M_SQRT1_2));
  if (z > -30) return -std::log(0.5 * std::erfc(-z * M_SQRT1_2));
  // Abramowitz and Stegun 26.2.12; the next term is 105 / z^8 < 2e-10 / 1e3 of the last digits.
  const double s = 1 / (z * z);
  const double series = 1 - s * (1 - s * (3 - s * (15 - s * 105)));
  return 0.5 * z * z + std::log(-z) + 0.5 * std::log(2 * M_PI) - std::log(series);
}

/// phi(z) / Phi(z): minus the derivative of the above.
inline double NormalHazard(double z) {
  constexpr double kPerRoot = 0.3989422804014327;  // 1 / sqrt(2 pi)
  if (z > -30) return kPerRoot * std::exp(-0.5 * z * z) / (0.5 * std::erfc(-z * M_SQRT1_2));
  const double s = 1 / (z * z);
  return -z / (1 - s * (1 - s * (3 - s * (15 - s * 105))));
}

}  // namespace graticule
