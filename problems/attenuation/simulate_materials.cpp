#include "graticule/problems/attenuation/simulate_materials.hpp"

#include <cmath>

namespace graticule {
namespace {

constexpr double kGhz = 2.4;
constexpr ItuMaterial kConcrete{5.31, 0.0326, 0.8095}, kBrick{3.75, 0.038, 0},
    kPlasterboard{2.94, 0.0116, 0.7076}, kGlass{6.27, 0.0043, 1.1925},
    kChipboard{2.58, 0.0217, 0.78};

/// Leaves of a material one behind the other, spread over the thickness that is drawn.
double WallDbPerM(const ItuMaterial& material, int leaves, double leaf_m, double drawn_m) {
  return leaves * (leaf_m * material.AttenuationDbPerM(kGhz) + 2 * material.FaceLossDb()) / drawn_m;
}

}  // namespace

double ItuMaterial::Conductivity(double ghz) const { return c * std::pow(ghz, d); }

double ItuMaterial::AttenuationDbPerM(double ghz) const {
  return 1636 * Conductivity(ghz) / std::sqrt(Permittivity());
}

double ItuMaterial::FaceLossDb() const {
  const double index = std::sqrt(Permittivity()), reflection = (index - 1) / (index + 1);
  return -10 * std::log10(1 - reflection * reflection);
}

double DrawnThickness(Filling wall) {
  switch (wall) {
    case Filling::kBrickWall:
      return 0.3;
    case Filling::kConcreteWall:
    case Filling::kBlockWall:
      return 0.2;
    default:
      return 0.1;
  }
}

const std::vector<FillingLoss>& FillingLosses() {
  static const std::vector<FillingLoss> losses = {
      {"air", false, 0},
      {"clutter", false, 0.1},
      // Two boards of 12.5 mm on either side of the studs.
      {"partition", true, WallDbPerM(kPlasterboard, 2, 0.025, DrawnThickness(Filling::kPartition))},
      // Hollow blocks: two leaves of 45 mm.
      {"block wall", true, WallDbPerM(kConcrete, 2, 0.045, DrawnThickness(Filling::kBlockWall))},
      {"brick wall", true, WallDbPerM(kBrick, 2, 0.1, DrawnThickness(Filling::kBrickWall))},
      {"concrete wall", true,
       WallDbPerM(kConcrete, 1, 0.2, DrawnThickness(Filling::kConcreteWall))},
      {"glass wall", true, WallDbPerM(kGlass, 2, 0.006, DrawnThickness(Filling::kGlassWall))},
      {"furniture", true, 3},
      // 0.4 of it is paper and board.
      {"bookshelf", true, 0.4 * kChipboard.AttenuationDbPerM(kGhz)},
      {"lift shaft", true, 20},
      {"car", true, 5},
      {"trunk", true, 10},
      {"hedge", true, 1.5}};
  return losses;
}

}  // namespace graticule
