#pragma once

#include <cstddef>
#include <string>

namespace graticule {

/// What a reader did to information matrices that were not positive definite.
struct RepairedInformation {
  std::size_t count = 0;           ///< matrices that were projected
  std::size_t of = 0;              ///< information matrices in the file
  double smallest_eigenvalue = 0;  ///< of all of them, as the factors would have had them
  double largest_change = 0;       ///< |after - before| / |before| (Frobenius)
  std::string first;               ///< "a.g2o:12"; of a binary file "a.fg, byte 1234"
};

/// One line for people.
std::string ToString(const RepairedInformation& repaired);

}  // namespace graticule
