#pragma once

#include <cstdint>
#include <vector>

namespace graticule {

/// What a cell of a simulated floor plan is filled with.
enum class Filling : std::uint8_t {
  kAir,
  kClutter,  ///< rooms in use: chairs, people, what a laser does not see
  kPartition,
  kBlockWall,
  kBrickWall,
  kConcreteWall,
  kGlassWall,
  kFurniture,
  kBookshelf,
  kLiftShaft,
  kCar,
  kTrunk,
  kHedge,
};

/// How a filling weakens a signal of 2.4 GHz.
struct FillingLoss {
  const char* name;
  bool is_structure;  ///< robots see it, and do not drive through
  double db_per_m;    ///< along the ray, over the thickness that it is drawn with
};

/// Electric properties by recommendation ITU-R P.2040-1, table 3: relative permittivity a f^b and
/// conductivity c f^d [S/m] at f GHz (b is 0 for all of these).
struct ItuMaterial {
  double a, c, d;

  double Permittivity() const { return a; }
  double Conductivity(double ghz) const;
  /// Inside of the material [dB/m]: 1636 conductivity / sqrt(permittivity), for dielectrics
  /// (P.2040-1, section 2.1).
  double AttenuationDbPerM(double ghz) const;
  /// What one face reflects at normal incidence is lost to the ray [dB].
  double FaceLossDb() const;
};

/// The losses of all fillings at 2.4 GHz.  Walls are made of leaves of ITU-R's materials, and their
/// loss (leaves and faces) is spread over the thickness that they are drawn with; what has no such
/// table is assumed (docs/signal_simulation.md).
const std::vector<FillingLoss>& FillingLosses();

inline const FillingLoss& LossOf(Filling filling) {
  return FillingLosses()[static_cast<std::size_t>(filling)];
}

/// What a wall is drawn with [m].
double DrawnThickness(Filling wall);

}  // namespace graticule
