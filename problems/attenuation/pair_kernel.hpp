#pragma once

#include <algorithm>
#include <cmath>

#include "graticule/io/signal_log.hpp"

namespace graticule {

/// The thesis' distance of two links, which does not mind who listens (Eq. 3.3) [m].
inline double LinkDistance(const SignalLink& a, const SignalLink& b) {
  return std::min(
      (a.receiver_m - b.receiver_m).norm() + (a.transmitter_m - b.transmitter_m).norm(),
      (a.receiver_m - b.transmitter_m).norm() + (a.transmitter_m - b.receiver_m).norm());
}

/// How alike two places are: 1 at distance 0, exp(-(d / length)^power), cut to zero at the support
/// by max(0, 1 - d / support)^taper as Eq. 3.4 has it.  Positive definite in space for powers of 1
/// and 2, with taper 3 as well.
struct PlaceKernel {
  double length_m = 1;
  int power = 1;         ///< 1: rough, exponential; 2: smooth, squared exponential
  double support_m = 0;  ///< 0: none
  double taper = 3;

  double operator()(double distance_m) const {
    if (support_m > 0 && distance_m >= support_m) return 0;
    const double scaled = distance_m / length_m;
    const double value = std::exp(power == 2 ? -scaled * scaled : -scaled);
    return support_m > 0 ? value * std::pow(1 - distance_m / support_m, taper) : value;
  }
};

/// Two links are alike where both their ends are: [k(r,r') k(t,t') + k(r,t') k(t,r')] / 2, the
/// product kernel made symmetric in who listens: positive definite where k is.
inline double PairSimilarity(const PlaceKernel& kernel, const SignalLink& a, const SignalLink& b) {
  return (kernel((a.receiver_m - b.receiver_m).norm()) *
              kernel((a.transmitter_m - b.transmitter_m).norm()) +
          kernel((a.receiver_m - b.transmitter_m).norm()) *
              kernel((a.transmitter_m - b.receiver_m).norm())) /
         2;
}

/// The thesis' kernel of Eq. 3.3 and 3.4.  NOT positive definite: a kernel of the smaller of two
/// distances need not be (kept because the thesis has it; PairSimilarity is the cure).
inline double ThesisSimilarity(const PlaceKernel& kernel, const SignalLink& a,
                               const SignalLink& b) {
  return kernel(LinkDistance(a, b));
}

}  // namespace graticule
