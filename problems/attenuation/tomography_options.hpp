#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "graticule/solver/loss.hpp"

namespace graticule {

/// What is believed of a class of cells before anything is measured.
struct AttenuationClass {
  std::string name;         ///< "free"
  double rho_db_per_m = 0;  ///< expected loss; above zero it weakens (the thesis' rho are gains)
  double phi = 1;           ///< weight of that: its standard deviation is sigma_db / phi
};

/// Offsets of radios that the model has.
enum class RadioBias {
  kNone,
  kRadio,  ///< one a radio, the same whether it sends or listens
  kEnds    ///< one of a radio that sends, another of it listening
};

/// A linear Gaussian model of signal strength (thesis equations 3.1, 3.2 and 3.5, Algorithms 3.1
/// and 3.2):
///
///     y = L0 - a log10(d / 1 m) + bias of receiver + bias of transmitter - sum length v + noise
///
/// with a grid of losses v [dB/m] a class.  Weights lambda and phi are relative to a noise of
/// sigma_db, as in the thesis, where every measurement's row has weight 1.
struct TomographyOptions {
  std::string name = "matte";

  // --- attenuation
  /// In the order of class numbers; none: no attenuation is modelled.
  std::vector<AttenuationClass> classes = {
      {"free", 0.05, 10}, {"structure", 2, 4}, {"unknown", 0.2, 10}};
  /// The class of cells that are unknown, free, structure.
  std::array<std::uint8_t, 3> class_of = {2, 0, 1};
  bool uses_map = true;   ///< false: all is of class 0
  double cell_m = 4;      ///< a coarse cell's side, at least 0.05; 0: one cell that is everywhere
  double lambda = 4;      ///< weight of neighbours of a class being alike
  int margin_cells = 1;   ///< cells so near to one that a ray crosses are estimated, too
  double outside_m = 10;  ///< positions further outside of the map are refused

  // --- path loss and radios
  double l0_dbm = -40, l0_sigma_db = 20;      ///< strength at 1 m
  double slope_db = 25, slope_sigma_db = 10;  ///< loss a factor of ten in distance
  double near_m = 0.1;                        ///< nearer ends count as this far apart
  RadioBias bias = RadioBias::kRadio;
  double bias_sigma_db = 3;

  // --- noise
  double sigma_db = 5;         ///< of one measurement, as first believed
  bool estimate_sigma = true;  ///< from what the model leaves over, at each Update
  double sigma_weight = 5;     ///< measurements that the first belief is worth
  /// Measurements of a link from nearly one place share this part of their noise's variance: n of
  /// them weigh n / (1 + (n - 1) correlation).  Below zero: estimated from what is left over.
  double correlation = -1;
  double forget_s = 0;  ///< weight falls by e in this time; 0: never
  Loss loss;            ///< over a row's whitened residual

  // --- rows: what a link says from nearly one place is one row of the mean place and strength
  double merge_m = 1;        ///< both ends within this of the row's first ones; 0: equal
  double merge_share = 0.1;  ///< nor more than this part of the distance between them
  double merge_s = 10;       ///< nor for longer than this

  // --- the solve, and how sure it is
  double tolerance =
      0.05;  ///< the preconditioned residual, against the noise, at which a solve ends
  int max_iterations = 1000;  ///< of a solve where much is new
  /// Of an Update where little is new, so that its time is bounded: what they leave is left to the
  /// next.
  int update_iterations = 5;
  int exact_up_to = 256;  ///< unknowns: up to so many the posterior is a matrix, above samples
  int samples = 64;       ///< of the posterior, a multiple of 16; 0: the noise alone
  std::uint64_t seed = 1;

  static TomographyOptions LogFit();
  /// Thesis 3.2.3's "single attenuation value to all pixels of the same class".
  static TomographyOptions OneAttenuationPerClass();
  /// Thesis 3.2.2: the map ignored, cells of 3 m.
  static TomographyOptions Mrt();
  /// Thesis 3.2.3: a grid of 4 m a class.
  static TomographyOptions Matte() { return {}; }

  /// Throws Error (kUsage): a weight that is not finite, a class_of beyond the classes, ...
  void Check() const;
};

}  // namespace graticule
