#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graticule/problems/attenuation/predictor.hpp"
#include "graticule/problems/attenuation/simulate.hpp"

namespace graticule {

/// A predictor that knows at each update the map as it was then, as robots do that explore.
class GrowingMap : public SignalPredictor {
 public:
  GrowingMap(std::unique_ptr<SignalPredictor> predictor, std::vector<TimedMap> maps)
      : predictor_(std::move(predictor)), maps_(std::move(maps)) {}

  /// The maps are given already.
  void SetMap(std::shared_ptr<const OccupancyGrid>) override {}
  void AddMeasurements(Span<const SignalMeasurement> measurements) override {
    predictor_->AddMeasurements(measurements);
  }
  void Update(double now_s) override {
    const std::size_t before = next_;
    while (next_ < maps_.size() && maps_[next_].time_s <= now_s) ++next_;
    if (next_ > before) predictor_->SetMap(maps_[next_ - 1].map);
    predictor_->Update(now_s);
  }
  void Expect(Span<const SignalLink> links) override { predictor_->Expect(links); }
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override {
    predictor_->Predict(links, predictions);
  }
  std::string Name() const override { return predictor_->Name(); }

 private:
  std::unique_ptr<SignalPredictor> predictor_;
  std::vector<TimedMap> maps_;
  std::size_t next_ = 0;
};

}  // namespace graticule
