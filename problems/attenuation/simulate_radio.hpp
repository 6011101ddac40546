#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <memory>
#include <vector>

#include "graticule/problems/attenuation/ray.hpp"
#include "graticule/problems/attenuation/simulate_plan.hpp"
#include "graticule/problems/random.hpp"

namespace graticule {

/// How signals of 2.4 GHz spread in a simulated place (docs/signal_simulation.md has the sources).
struct RadioOptions {
  double l0_dbm = -30;        ///< strength at 1 m
  double ceiling_db = 29;     ///< of walls together: what goes around them is left
  double shadowing_db = 4.5;  ///< standard deviation, beside walls
  double k_in_sight_db = 6;   ///< Rician factor without a wall between
  double k_hidden_db = -20;   ///< behind walls of 10 dB and more
  int diversity = 3;          ///< parts of the band that fade independently
  double fading_m = 0.043;    ///< a path's amplitude forgets itself over so many metres driven
  double fading_s = 5;        ///< and in so many seconds
  double bias_db = 2.5;       ///< standard deviation of a radio, whether it sends or listens
  double end_bias_db = 0.35;  ///< and beside that of its sending and of its listening
  double step_db = 1;         ///< of the strengths that are reported
  double floor_dbm = -92;     ///< weaker packets are not heard
};

/// A random loss field whose integral along a link is its shadowing (Agrawal and Patwari 2009): all
/// links agree about it, and it is the same from either end.  A sum of Gaussian fields of several
/// lengths, weighed such that links which share an end correlate as measured.
class ShadowField {
 public:
  ShadowField(double width_m, double height_m, double sigma_db, std::uint64_t seed);

  /// The shadowing of a link [dB], of mean 0; its deviation is sigma_db for links much longer than
  /// the field's lengths.  Swapping the ends changes nothing but rounding.
  double LossDb(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

 private:
  double cell_m_ = 0.1;
  std::size_t width_, height_;
  std::vector<float> field_;  // dB / sqrt(m)
};

/// A place as radio waves find it.
class RadioWorld {
 public:
  RadioWorld(const FloorPlan& plan, const RadioOptions& options, std::uint64_t seed);

  /// Losses of all that a link goes through, as a sum [dB], and as they count with the ceiling.
  double MaterialLossDb(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);
  double CountedLossDb(double material_loss_db) const;
  /// Strength without fading and biases [dBm].
  double MeanDbm(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m,
                 double material_loss_db) const;

  const RadioOptions& Options() const { return options_; }

 private:
  RadioOptions options_;
  double exponent_;
  std::unique_ptr<ClassMap> map_;
  RayTracer tracer_;
  ShadowField shadows_;
};

/// Multipath of one link as its ends move: in each part of the band a path of constant strength and
/// scattered ones (Rice), whose amplitude is a Gauss-Markov process in distance and time.
class LinkFading {
 public:
  LinkFading(const RadioOptions& options, RandomNumbers* random);

  /// What fading adds [dB], after both ends together have moved so far.
  double Next(double moved_m, double elapsed_s, double material_loss_db);

 private:
  const RadioOptions& options_;
  RandomNumbers* random_;
  std::vector<std::complex<double>> scattered_;
};

}  // namespace graticule
