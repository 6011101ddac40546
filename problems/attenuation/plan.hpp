#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graticule/problems/attenuation/predictor.hpp"

namespace graticule {

/// Two radios of a team, and how well they hear each other.
struct TeamLink {
  std::uint32_t a = 0, b = 0;
  SignalPrediction prediction;  ///< the mean of both ways
  double probability = 0;       ///< that the strength is at least what is usable
};

/// Who can talk to whom, and whether all can reach all.
struct TeamConnectivity {
  std::vector<TeamLink> links;  ///< every pair, by a and then b
  /// That links which are up join the whole team; links are taken to be independent.
  double connected = 0;
  /// The links without which nobody is left out, of the largest product of probabilities.
  std::vector<std::size_t> backbone;
};

/// The team's connectivity graph at these places.  `radios` are the predictor's numbers; `now_s` is
/// the time that is asked for, not before what `predictor` has learnt.
TeamConnectivity Connect(const SignalPredictor& predictor, const std::vector<std::uint32_t>& radios,
                         const std::vector<Eigen::Vector3d>& at_m, double usable_dbm, double now_s);

/// A place to measure from, and what that tells about the model.
struct WorthwhilePlace {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double gain_nats = 0;  ///< information of one measurement to each of the others
  double sigma_db = 0;   ///< the largest predicted deviation among those
};

/// Where a robot should measure next: candidates by information gain, 0.5 log(predicted variance /
/// noise variance) summed over links to the others, the best first and each next one as if those
/// before had been measured (greedy; Krause, Singh, Guestrin 2008).  No candidate comes twice: what
/// is to be learnt there is learnt while the robot is there.  `now_s`: the time of those
/// measurements, not before those that `predictor` has learnt; it learns the imagined ones, so give
/// it a copy.
std::vector<WorthwhilePlace> WhereToMeasure(SignalPredictor* predictor, double noise_db,
                                            double now_s, std::uint32_t radio,
                                            const std::vector<std::uint32_t>& others,
                                            const std::vector<Eigen::Vector3d>& others_m,
                                            std::vector<Eigen::Vector3d> candidates,
                                            std::size_t count);

}  // namespace graticule
