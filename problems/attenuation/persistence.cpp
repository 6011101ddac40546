#include "graticule/problems/attenuation/persistence.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

std::pair<std::uint32_t, std::uint32_t> RadiosOf(const SignalLink& link) {
  return std::minmax(link.receiver, link.transmitter);
}

}  // namespace

void Persistence::AddMeasurements(Span<const SignalMeasurement> measurements) {
  mean_.AddMeasurements(measurements);
  for (const SignalMeasurement& measurement : measurements) {
    auto& last = last_[RadiosOf(measurement.link)];
    last.push_back(measurement);
    if (last.size() > kept_) last.pop_front();
  }
}

void Persistence::Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const {
  mean_.Predict(links, predictions);
  std::vector<SignalLink> then;
  std::vector<SignalPrediction> expected;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto found = last_.find(RadiosOf(links[i]));
    if (found == last_.end()) continue;
    const auto& last = found->second;
    then.clear();
    for (const SignalMeasurement& measurement : last) then.push_back(measurement.link);
    expected.resize(then.size());
    mean_.Predict(then, {expected.data(), expected.size()});
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < last.size(); ++k) {
      const double residual = last[k].dbm - expected[k].dbm;
      sum += residual;
      squares += residual * residual;
    }
    const double count = static_cast<double>(last.size()), kept = sum / count;
    const double age = std::max(0.0, links[i].time_s - last.back().link.time_s);
    const double part = std::exp(-age / decay_s_);
    predictions[i].dbm += part * kept;
    // What the residuals scatter about their mean stays; the rest of the log-fit's variance comes
    // back as the memory fades.  Few residuals say little of their scatter: two more, of its half.
    const double whole = predictions[i].sigma_db * predictions[i].sigma_db;
    const double scatter = (squares - count * kept * kept + whole) / (count + 1);
    const double now = std::min(whole, scatter * (1 + 1 / count));
    predictions[i].sigma_db = std::sqrt(part * part * now + (1 - part * part) * whole);
  }
}

}  // namespace graticule
