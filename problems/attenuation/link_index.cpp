#include "graticule/problems/attenuation/link_index.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {

std::int64_t LinkIndex::CellOf(double x_m) const {
  // Places beyond two thousand million cells share the last ones.
  constexpr double kLast = 2147483000;
  return static_cast<std::int64_t>(std::floor(std::max(-kLast, std::min(x_m / cell_m_, kLast))));
}

void LinkIndex::Add(std::uint32_t number, const SignalLink& link) {
  cells_[Key(CellOf(link.receiver_m.x()), CellOf(link.receiver_m.y()))].push_back(number);
}

}  // namespace graticule
