#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graticule/problems/attenuation/link_index.hpp"
#include "graticule/problems/attenuation/pair_kernel.hpp"
#include "graticule/problems/attenuation/predictor.hpp"

namespace graticule {

/// What the mean leaves over, as a sum of independent parts, each with a standard deviation:
/// something about a pair of places, something about a link for a while, something about a link
/// for good, something about each of its radios, and noise.
struct ResidualGpOptions {
  std::string name = "residual-gp";
  // But radio_db, tuned on the drive tests/test_robot_df of the set kolak_ble_flat.
  PlaceKernel place{6, 1, 0, 3};
  double place_db = 10;
  double link_db = 2.83, link_s = 3.54;  ///< fades as exp(-time / link_s)
  double offset_db = 2;
  double radio_db = 3;  ///< of each end; 0 where the mean has biases
  double noise_db = 3.53;
  /// Measurements of a link from nearly one place and time count as one point, of less noise: both
  /// ends within merge_m of the point's first ones, and within merge_s.
  double merge_m = 0.2, merge_s = 2;
  /// Points a prediction is made of: the link's newest, and the nearest by LinkDistance of all
  /// others.
  std::size_t newest = 20, nearest = 60;

  /// Throws Error (kUsage): a deviation, length or time that is not above zero
  /// (radio_db, merge_m and merge_s: below zero).
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
  void Update(double now_s) override { mean_->Update(now_s); }
  void Expect(Span<const SignalLink> links) override { mean_->Expect(links); }
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return options_.name; }

  const ResidualGpOptions& Options() const { return options_; }
  std::size_t PointCount() const { return points_.size(); }
  const SignalPredictor& Mean() const { return *mean_; }

 private:
  using Radios = std::pair<std::uint32_t, std::uint32_t>;
  /// Of one or more measurements, their means.
  struct Point {
    SignalLink link;
    double dbm = 0, count = 0;
    SignalLink first;
  };
  /// What a covariance needs of some points, one array each, so that loops over it are short.
  struct Columns;
  struct Workspace;

  void Merge(const SignalMeasurement& measurement);
  void PointsFor(const SignalLink& link, std::vector<std::pair<double, std::uint32_t>>* heap,
                 std::vector<std::uint32_t>* chosen) const;
  /// Of points, which are in order; into values that are numbered as points are.
  void SetResiduals(const std::vector<std::uint32_t>& points, std::vector<double>* values) const;
  void Covariances(const Columns& points, Eigen::Index from, const SignalLink& link,
                   Workspace* work, Eigen::Ref<Eigen::VectorXd> values) const;
  double Variance(const SignalLink& link) const;
  /// The points' covariance, noise with it, and its Cholesky factor in the lower half of
  /// work->matrix; false: it has none.
  bool Factorise(const std::uint32_t* chosen, std::size_t count, Workspace* work) const;
  void PredictTogether(const std::uint32_t* chosen, std::size_t count,
                       const std::vector<double>& residuals, Span<const SignalLink> links,
                       Workspace* work, Span<SignalPrediction> predictions) const;

  std::unique_ptr<SignalPredictor> mean_;
  ResidualGpOptions options_;
  std::vector<Point> points_;
  std::map<Radios, std::vector<std::uint32_t>> of_link_;  // indices into points_, in time's order
  LinkIndex index_;
};

}  // namespace graticule
