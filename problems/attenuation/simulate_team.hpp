#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graticule/io/signal_log.hpp"
#include "graticule/problems/attenuation/simulate_radio.hpp"

namespace graticule {

/// Radios on robots robot1, robot2, ... that all listen to each other, wherever somebody drives
/// them.
class TeamRadios {
 public:
  /// The place's seed draws its shadows; `seed` radios and fading.
  TeamRadios(const FloorPlan& plan, const RadioOptions& options, std::size_t robots,
             std::uint64_t place_seed, std::uint64_t seed);
  TeamRadios(const TeamRadios&) = delete;
  TeamRadios& operator=(const TeamRadios&) = delete;

  /// Everybody sends a packet, and all others listen.  `at_m`: antennas in the map's frame;
  /// `driven_m` and `elapsed_s` since the packets before.
  void Send(double time_s, const std::vector<Eigen::Vector3d>& at_m,
            const std::vector<double>& driven_m, double elapsed_s);

  /// What a packet would be received with without fading [dBm].
  double ExpectedDbm(std::size_t transmitter, std::size_t receiver,
                     const Eigen::Vector3d& transmitter_m, const Eigen::Vector3d& receiver_m);

  const SignalLog& Log() const { return log_; }
  /// Of each radio: whichever way, and beside that of its sending and of its listening [dB].
  const std::vector<double>& BiasDb() const { return bias_db_; }
  const std::vector<double>& SendingBiasDb() const { return sending_bias_db_; }
  const std::vector<double>& ListeningBiasDb() const { return listening_bias_db_; }

 private:
  RadioWorld world_;
  RandomNumbers random_;
  SignalLog log_;
  std::vector<double> bias_db_, sending_bias_db_, listening_bias_db_;
  std::vector<LinkFading> fading_;  // of each pair
};

}  // namespace graticule
