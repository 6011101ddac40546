#pragma once

#include <Eigen/Core>
#include <string>

#include "graticule/problems/attenuation/predictor.hpp"

namespace graticule {

/// Links shorter than this count as this long: the antennas' near field, and log10(0).
constexpr double kShortestLink_m = 0.1;

/// Path loss alone, y = L0 - a log10(d), by least squares in closed form (thesis 3.1), or the mean
/// alone.  One measurement's deviation is that of the residuals and of a belief that is worth a few
/// of them; the coefficients' uncertainty comes to it.
class LogFit : public SignalPredictor {
 public:
  explicit LogFit(bool use_distance = true) : use_distance_(use_distance) {}

  void SetMap(std::shared_ptr<const OccupancyGrid>) override {}
  void AddMeasurements(Span<const SignalMeasurement> measurements) override;
  void Update(double now_s) override;
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return use_distance_ ? "log-fit" : "mean"; }

  /// [L0 dBm, -a dB per decade].
  const Eigen::Vector2d& Coefficients() const { return coefficients_; }
  double SigmaDb() const { return sigma_db_; }

 private:
  Eigen::Vector2d Row(const SignalLink& link) const;

  bool use_distance_;
  // Before the first measurement: free space, of a radio that nobody has heard of.
  Eigen::Matrix2d information_ = Eigen::Vector2d(1e-4, 1e-3).asDiagonal();
  Eigen::Vector2d right_hand_side_{-40e-4, -20e-3};
  double squares_ = 0.16 + 0.4;  // of the strengths, and of what was believed
  double count_ = 0;
  Eigen::Vector2d coefficients_{-40, -20};
  Eigen::Matrix2d covariance_ = Eigen::Vector2d(1e4, 1e3).asDiagonal();  // of noise 1
  double sigma_db_ = 10;
};

/// Throws Error (kInput): a measurement that is not finite.
void CheckMeasurements(Span<const SignalMeasurement> measurements);

}  // namespace graticule
