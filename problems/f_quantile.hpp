#pragma once

namespace graticule {

/// The x below which a share p in (0, 1) of Fisher's F distribution lies, to rounding: of the ratio
/// of two mean squares with these degrees of freedom, both above 0.
double FQuantile(double p, double degrees_above, double degrees_below);

/// The share of it that lies above x.
double FExceeded(double x, double degrees_above, double degrees_below);

}  // namespace graticule
