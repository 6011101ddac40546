#pragma once

namespace graticule {

/// Share of a chi-square distribution with that many degrees of freedom (above 0) that lies below
/// x: the regularised lower incomplete gamma function P(degrees / 2, x / 2).
double ChiSquareShare(double x, double degrees);

/// The x below which a share p of it lies, to rounding; p in (0, 1).
double ChiSquareQuantile(double p, double degrees);

}  // namespace graticule
