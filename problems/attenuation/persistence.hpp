#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "graticule/problems/attenuation/log_fit.hpp"

namespace graticule {

/// "Keep the last value": the log-fit, and the mean of a link's last residuals on top of it, which
/// fades with their age (a link is a pair of radios, whoever listens).
class Persistence : public SignalPredictor {
 public:
  explicit Persistence(double decay_s = 30, std::size_t kept = 5)
      : decay_s_(decay_s), kept_(kept) {}

  void SetMap(std::shared_ptr<const OccupancyGrid>) override {}
  void AddMeasurements(Span<const SignalMeasurement> measurements) override;
  void Update(double now_s) override { mean_.Update(now_s); }
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return "persistence"; }

 private:
  double decay_s_;
  std::size_t kept_;
  LogFit mean_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::deque<SignalMeasurement>> last_;
};

}  // namespace graticule
