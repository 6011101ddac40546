#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graticule/problems/attenuation/pair_kernel.hpp"
#include "graticule/problems/attenuation/predictor.hpp"

namespace graticule {

/// What the mean leaves over, as a sum of independent parts, each with a standard deviation:
/// something about a pair of places, something about a link for a while, something about a link
/// for good, and noise.
struct ResidualGpOptions {
  std::string name = "residual-gp";
  PlaceKernel place{1.5, 1, 0, 3};
  double place_db = 3;
  double link_db = 2, link_s = 5;  ///< fades as exp(-time / link_s)
  double offset_db = 1;
  double noise_db = 4.2;
  /// All but offset_db, by marginal likelihood, as data doubles.  Of residuals of a mean that was
  /// fitted to the same measurements it learns too little noise (docs/signal_evaluation.md).
  bool learn = false;
  /// Points a prediction is made of: the link's newest, and the nearest by LinkDistance of all
  /// others.
  std::size_t newest = 40, nearest = 80;

  /// Throws Error (kUsage): a deviation, length or time that is not above zero.
  void Check() const;
};

/// A Gaussian process in space and time on the residual of any mean, made anew for each prediction
/// of the points that matter to it: exact in those, and bounded in time however long the log.
/// Measurements that were not heard go to the mean only.
class ResidualGp : public SignalPredictor {
 public:
  ResidualGp(std::unique_ptr<SignalPredictor> mean, ResidualGpOptions options);

  void SetMap(std::shared_ptr<const OccupancyGrid> map) override { mean_->SetMap(std::move(map)); }
  void AddMeasurements(Span<const SignalMeasurement> measurements) override;
  void Update(double now_s) override;
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return options_.name; }

  const ResidualGpOptions& Options() const { return options_; }
  const SignalPredictor& Mean() const { return *mean_; }

 private:
  using Radios = std::pair<std::uint32_t, std::uint32_t>;

  double Covariance(const SignalLink& a, const SignalLink& b) const;
  std::vector<std::uint32_t> PointsFor(const SignalLink& link) const;
  std::vector<double> Residuals(const std::vector<std::uint32_t>& points) const;
  void PredictTogether(Span<const SignalLink> links, Span<SignalPrediction> predictions) const;
  void Learn();

  std::unique_ptr<SignalPredictor> mean_;
  ResidualGpOptions options_;
  std::vector<SignalMeasurement> points_;
  std::map<Radios, std::vector<std::uint32_t>> of_link_;  // indices into points_, in time's order
  std::size_t learnt_at_ = 0;
};

}  // namespace graticule
