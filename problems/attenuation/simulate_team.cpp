#include "graticule/problems/attenuation/simulate_team.hpp"

#include <cmath>
#include <string>
#include <utility>

namespace graticule {
namespace {

/// What a receiver reports of a strength.
SignalMeasurement Hear(const SignalLink& link, double dbm, const RadioOptions& radio) {
  SignalMeasurement measurement;
  measurement.link = link;
  measurement.is_heard = dbm >= radio.floor_dbm;
  measurement.dbm =
      measurement.is_heard ? std::round(dbm / radio.step_db) * radio.step_db : radio.floor_dbm;
  return measurement;
}

}  // namespace

TeamRadios::TeamRadios(const FloorPlan& plan, const RadioOptions& options, std::size_t robots,
                       std::uint64_t place_seed, std::uint64_t seed)
    : world_(plan, options, place_seed), random_(seed, 4) {
  RandomNumbers biases(seed, 3);
  for (std::size_t i = 0; i < robots; ++i) {
    log_.radios.push_back("robot" + std::to_string(i + 1));
    bias_db_.push_back(options.bias_db * biases.Normal());
    sending_bias_db_.push_back(options.end_bias_db * biases.Normal());
    listening_bias_db_.push_back(options.end_bias_db * biases.Normal());
  }
  for (std::size_t i = 1; i < robots; ++i)
    for (std::size_t other = 0; other < i; ++other)
      fading_.emplace_back(world_.Options(), &random_);
}

void TeamRadios::Send(double time_s, const std::vector<Eigen::Vector3d>& at_m,
                      const std::vector<double>& driven_m, double elapsed_s) {
  std::size_t pair = 0;
  for (std::size_t a = 0; a < at_m.size(); ++a)
    for (std::size_t b = a + 1; b < at_m.size(); ++b, ++pair) {
      const double material = world_.MaterialLossDb(at_m[a], at_m[b]);
      const double shared = world_.MeanDbm(at_m[a], at_m[b], material) +
                            fading_[pair].Next(driven_m[a] + driven_m[b], elapsed_s, material) +
                            bias_db_[a] + bias_db_[b];
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        SignalLink link;
        link.time_s = time_s;
        link.transmitter = static_cast<std::uint32_t>(from);
        link.receiver = static_cast<std::uint32_t>(to);
        link.transmitter_m = at_m[from];
        link.receiver_m = at_m[to];
        const double dbm = shared + sending_bias_db_[from] + listening_bias_db_[to];
        log_.measurements.push_back(Hear(link, dbm, world_.Options()));
      }
    }
}

double TeamRadios::ExpectedDbm(std::size_t transmitter, std::size_t receiver,
                               const Eigen::Vector3d& transmitter_m,
                               const Eigen::Vector3d& receiver_m) {
  const double material = world_.MaterialLossDb(transmitter_m, receiver_m);
  return world_.MeanDbm(transmitter_m, receiver_m, material) + bias_db_[transmitter] +
         bias_db_[receiver] + sending_bias_db_[transmitter] + listening_bias_db_[receiver];
}

}  // namespace graticule
