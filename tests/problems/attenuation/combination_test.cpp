#include "graticule/problems/attenuation/combination.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"
#include "predictions.hpp"

namespace graticule {
namespace {

using test::LinksOf;
using test::Predicted;

/// The last value that was heard times `part`, plus an offset, and sure of it to 1 dB.
class LastTimes : public SignalPredictor {
 public:
  explicit LastTimes(double part, double offset = 0) : part_(part), offset_(offset) {}
  void SetMap(std::shared_ptr<const OccupancyGrid>) override {}
  void AddMeasurements(Span<const SignalMeasurement> measurements) override {
    for (const SignalMeasurement& m : measurements) last_ = m.dbm;
  }
  void Update(double) override {}
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override {
    for (std::size_t i = 0; i < links.size(); ++i) predictions[i] = {part_ * last_ + offset_, 1};
  }
  std::string Name() const override { return "last"; }

 private:
  double part_, offset_, last_ = 0;
};

Combination::Members Two(double part, double other_part, double other_offset = 0) {
  Combination::Members members;
  members.push_back(std::make_unique<LastTimes>(part));
  members.push_back(std::make_unique<LastTimes>(other_part, other_offset));
  return members;
}

/// One link, twice a second, of deviation 3 dB, that forgets itself in `memory_s` (0: at once).
std::vector<SignalMeasurement> Wandering(int count, double memory_s) {
  std::vector<SignalMeasurement> all(static_cast<std::size_t>(count));
  RandomNumbers random(5);
  const double kept = memory_s > 0 ? std::exp(-0.5 / memory_s) : 0;
  double value = 0;
  for (int i = 0; i < count; ++i) {
    value = kept * value + std::sqrt(1 - kept * kept) * 3 * random.Normal();
    SignalMeasurement& m = all[static_cast<std::size_t>(i)];
    m.link.time_s = 0.5 * i;
    m.link.transmitter = 1;
    m.dbm = value;
  }
  return all;
}

TEST(Combination, WeighsByWhatCameTrueAndScalesItsDeviations) {
  // One member is right but for the noise, the other 2 dB off; both say 1 dB where it is 3.
  Combination combination(Two(0, 0, 2), Two(0, 0, 2));
  EXPECT_EQ(combination.NearWeights()[0], 0.5);
  combination.AddMeasurements(Wandering(4000, 0));
  combination.Update(2000);
  EXPECT_GT(combination.NearWeights()[0], 0.9);
  EXPECT_GT(combination.FarWeights()[0], 0.9);
  EXPECT_NEAR(combination.NearWeights().sum(), 1, 1e-12);
  const auto test = Wandering(4000, 0);
  double covered = 0;
  std::vector<SignalLink> links = LinksOf(test);
  for (SignalLink& link : links) link.time_s += 2000;
  const auto predictions = Predicted(combination, links);
  for (std::size_t i = 0; i < test.size(); ++i)
    covered += std::abs(test[i].dbm - predictions[i].dbm) <= 1.645 * predictions[i].sigma_db;
  EXPECT_NEAR(covered / static_cast<double>(test.size()), 0.9, 0.03);
}

TEST(Combination, TrustsNewsOfNowAndTheMeanOfLater) {
  Combination combination(Two(1, 0), Two(1, 0));
  combination.AddMeasurements(Wandering(20000, 6));
  combination.Update(10000);
  // The best linear weight of the last value is its correlation: exp(-1 / 6) a second on in the
  // middle, and exp(-19 / 6) later.
  EXPECT_NEAR(combination.NearWeights()[0], std::exp(-1.25 / 6), 0.08);
  EXPECT_NEAR(combination.FarWeights()[0], std::exp(-19.25 / 6), 0.08);
  EXPECT_LT(combination.NearScale(), combination.FarScale());
}

TEST(Combination, LearnsOfALogAsIfItHadComeStepByStep) {
  const auto log = Wandering(400, 6);
  Combination whole(Two(1, 0), Two(1, 0)), stepwise(Two(1, 0), Two(1, 0));
  whole.AddMeasurements(log);
  whole.Update(200);
  for (std::size_t i = 0; i < log.size(); i += 4) {
    stepwise.AddMeasurements({log.data() + i, 4});
    stepwise.Update(0.5 * static_cast<double>(i + 4));
  }
  EXPECT_EQ(whole.NearWeights(), stepwise.NearWeights());
  EXPECT_EQ(whole.FarWeights(), stepwise.FarWeights());
  EXPECT_EQ(whole.FarScale(), stepwise.FarScale());
}

TEST(Combination, LearnsNothingOfItsMembersOverAPause) {
  Combination combination(Two(0, 0, 6), Two(0, 0, 6));
  auto log = Wandering(8, 0);
  for (std::size_t i = 4; i < 8; ++i) log[i].link.time_s += 600;
  combination.AddMeasurements(log);
  combination.Update(700);
  EXPECT_EQ(combination.NearWeights()[0], 0.5);
  EXPECT_EQ(combination.NearScale(), 1);
}

TEST(Combination, RefusesWhatDoesNotHold) {
  CombinationOptions options;
  options.far_s = 0;
  EXPECT_THROW(Combination(Two(1, 0), Two(1, 0), options), Error);
  EXPECT_THROW(Combination({}, {}), Error);
  EXPECT_THROW(Combination(Two(1, 0), {}), Error);
  EXPECT_EQ(MakePredictor(kBestMethod)->Name(), kBestMethod);
}

}  // namespace
}  // namespace graticule
