#include "graticule/problems/mapping/sight_conflict.hpp"

#include <cmath>

namespace graticule {
namespace {

constexpr std::int32_t kNear = 2;    // cells
constexpr std::size_t kEnough = 30;  // cells that both know

void AddConflict(const OccupancyMap& here, const OccupancyMap& there,
                 const PlanarPose& there_from_here, SightConflict* sum) {
  const CellBox box = here.KnownBox();
  for (std::int32_t y = box.bottom; y < box.bottom + box.height; ++y)
    for (std::int32_t x = box.left; x < box.left + box.width; ++x) {
      if (here.At(x, y) != Occupancy::kStructure) continue;
      double there_x = 0, there_y = 0;
      there_from_here.Transform((x + 0.5) * here.Resolution(), (y + 0.5) * here.Resolution(),
                                &there_x, &there_y);
      const auto u = static_cast<std::int32_t>(std::floor(there_x / there.Resolution()));
      const auto v = static_cast<std::int32_t>(std::floor(there_y / there.Resolution()));
      bool is_structure = false, is_free = true;
      for (std::int32_t j = -kNear; j <= kNear; ++j)
        for (std::int32_t i = -kNear; i <= kNear; ++i) {
          const Occupancy cell = there.At(u + i, v + j);
          is_structure |= cell == Occupancy::kStructure;
          is_free &= cell == Occupancy::kFree;
        }
      sum->agree += is_structure;
      sum->conflict += is_free;
    }
}

}  // namespace

double SightConflict::Share() const {
  const std::size_t known = agree + conflict;
  return known < kEnough ? 0 : static_cast<double>(conflict) / static_cast<double>(known);
}

SightConflict ConflictOf(const OccupancyMap& a, const OccupancyMap& b, const PlanarPose& a_from_b) {
  SightConflict sum;
  AddConflict(b, a, a_from_b, &sum);
  AddConflict(a, b, Inverse(a_from_b), &sum);
  return sum;
}

}  // namespace graticule
