#pragma once

#include <optional>

#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/problems/calibration/suggest.hpp"

namespace graticule {

/// How a simulated person moves.
struct PersonOptions {
  HandNoise hands;           ///< of the first attempt at a suggestion
  double correction = 0.35;  ///< of that noise is left after each look at the screen
  double look_s = 0.9;       ///< from one look to the next
  double reach_s = 0.25;     ///< time constant of a movement
  double tremor = 0.0006;    ///< as HandNoise::across, of a hand that holds still
  std::uint64_t seed = 1;
};

/// Someone who sees hollow quads on a screen and brings a target to where they match: towards it
/// at first roughly (HeldAt), then nearer with each look, and never quite still.  What they match
/// is the picture, by the true camera, whatever the session believes of it.
class SimulatedPerson {
 public:
  SimulatedPerson(const Camera& truth, const TargetLayout& target,
                  const PersonOptions& options = {});

  /// Where the target is (camera_from_target) so much later.  Without a suggestion it stays where
  /// it is.  `number` tells one suggestion from the next.
  Se3Array Step(const std::optional<Suggestion>& suggestion, std::size_t number, double seconds);

 private:
  Camera truth_;
  TargetLayout target_;
  PersonOptions options_;
  RandomNumbers random_;
  std::optional<std::size_t> number_;
  std::optional<Se3Array> wanted_;  // what matches the suggestion best
  Se3Array goal_, now_;
  double since_look_s_ = 0, noise_ = 1;
};

}  // namespace graticule
