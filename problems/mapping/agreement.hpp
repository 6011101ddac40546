#pragma once

#include <cstddef>

#include "graticule/problems/mapping/occupancy_map.hpp"

namespace graticule {

/// A map held against another of the same lattice, cell by cell.
struct MapAgreement {
  std::size_t structure_both = 0, structure_either = 0;
  std::size_t free_both = 0, free_either = 0;
  std::size_t known = 0;            ///< in the reference
  std::size_t known_both = 0;       ///< of these, in the map
  std::size_t different_known = 0;  ///< of these, with another label
  std::size_t different = 0;        ///< cells whose label is not the same

  double StructureIou() const { return Share(structure_both, structure_either); }
  double FreeIou() const { return Share(free_both, free_either); }
  double KnownRecall() const { return Share(known_both, known); }

 private:
  static double Share(std::size_t part, std::size_t whole) {
    return whole == 0 ? 1 : static_cast<double>(part) / static_cast<double>(whole);
  }
};

MapAgreement Agreement(const OccupancyMap& map, const OccupancyMap& reference);

}  // namespace graticule
