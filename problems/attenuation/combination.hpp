#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/predictor.hpp"

namespace graticule {

struct CombinationOptions {
  std::string name = "combined";
  double step_s = 2;  ///< how far ahead members are scored as they are
  double far_s = 18;  ///< and as they were so long before
  /// Scored measurements that the first beliefs are worth: equal weights, deviations as members
  /// say.
  double prior_count = 100;

  /// Throws Error (kUsage): a time or count that is not above zero.
  void Check() const;
};

/// Several methods as one: the mean of their predictions, with the weights, none below zero, that
/// would have had the least squared error so far, and deviations scaled as its own errors so far
/// demand.  Whatever it learns of its members it learns from predictions they made before they knew
/// what came, as a replay does: of what came next, and, by a second set of members that is kept
/// `far_s` behind, of what came so much later.  Between the two, weights and scale go with the
/// square root of the time ahead, as errors that drift do.
///
/// Weights: stacking by squared error (Breiman, Stacked regressions, Machine Learning 24, 1996),
/// online; the variance is that of the members' mixture.
class Combination : public SignalPredictor {
 public:
  using Members = std::vector<std::unique_ptr<SignalPredictor>>;

  /// The second set is made as the first.  Throws Error (kUsage): options that do not hold; no
  /// members, more than eight, or sets of different sizes.
  Combination(Members members, Members lagging, CombinationOptions options = {});

  void SetMap(std::shared_ptr<const OccupancyGrid> map) override;
  void AddMeasurements(Span<const SignalMeasurement> measurements) override;
  /// What was added since the last time is learnt in steps of step_s, as if it had come by them.
  void Update(double now_s) override;
  void Expect(Span<const SignalLink> links) override {
    for (const auto& member : members_) member->Expect(links);
  }
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return options_.name; }

  /// As they are now.
  const Members& Now() const { return members_; }
  /// Of the members in their order, for what comes next and for far_s ahead; sums are 1.
  const Eigen::VectorXd& NearWeights() const { return near_.weights; }
  const Eigen::VectorXd& FarWeights() const { return far_.weights; }
  /// What deviations are multiplied by.
  double NearScale() const { return near_.scale; }
  double FarScale() const { return far_.scale; }

 private:
  /// What errors at one time ahead have told.
  struct Record {
    Eigen::MatrixXd products;  // of the members' errors, summed [dB^2]
    double count = 0, scaled_squares = 0;
    Eigen::VectorXd weights;
    double scale = 1;
  };

  void Learn(Span<const SignalMeasurement> measurements, double now_s);
  static void Score(const Members& members, Span<const SignalMeasurement> measurements,
                    Record* record);
  void Weigh(const Eigen::VectorXd& prior_weights, double prior_scale, Record* record) const;

  Members members_, lagging_;
  CombinationOptions options_;
  Record near_, far_;
  std::vector<SignalMeasurement> fresh_;   // added, not yet learnt
  std::vector<SignalMeasurement> recent_;  // learnt by members_, not yet by lagging_
  double now_s_ = 0, newest_s_, lagging_newest_s_;
};

}  // namespace graticule
