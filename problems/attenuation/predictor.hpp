#pragma once

#include <memory>
#include <string>

#include "graticule/io/occupancy.hpp"
#include "graticule/io/signal_log.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// What a measurement over a link would be: Gaussian, noise of the measurement included.
struct SignalPrediction {
  double dbm = 0;
  double sigma_db = 0;
};

/// A way to predict signal strength, which learns as measurements come (thesis 3.2).
///
/// Used by the replay, by `graticule signal`, and in a planner's loop: measurements are added as
/// they come, Update makes what was added count, Predict may then be called any number of times,
/// by several threads at once.  The same calls give the same digits.
class SignalPredictor {
 public:
  virtual ~SignalPredictor() = default;

  /// What lies between radios; from then on, for old measurements as well as new ones.  Methods
  /// that need no map ignore it.
  virtual void SetMap(std::shared_ptr<const OccupancyGrid> map) = 0;

  /// In the order of time.  A packet not heard is known to be below its floor: Tomography and
  /// FittedTomography take it so, ResidualGp leaves it to its mean; mean, log-fit, persistence and
  /// the processes of GaussianProcess take it as heard at the floor.  Throws Error (kInput): not
  /// finite, outside of the map.
  virtual void AddMeasurements(Span<const SignalMeasurement> measurements) = 0;

  /// Learns from what was added.  `now_s` is the time up to which measurements were taken.
  virtual void Update(double now_s) = 0;

  /// These links will be predicted more than once: what can be done once for each of them is done
  /// now, and kept until the next call, which may name many of them again.  Changes how long
  /// predictions take, and nothing else.  Throws as Predict does.
  virtual void Expect(Span<const SignalLink>) {}

  /// One prediction a link.  Before the first measurement: the prior, with its uncertainty.
  virtual void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const = 0;

  /// "matte", "mrt", "mrgp", "log-fit", ...
  virtual std::string Name() const = 0;
};

}  // namespace graticule
