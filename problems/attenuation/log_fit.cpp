#include "graticule/problems/attenuation/log_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {

void CheckMeasurements(Span<const SignalMeasurement> measurements) {
  for (const SignalMeasurement& measurement : measurements) {
    const SignalLink& link = measurement.link;
    if (!std::isfinite(measurement.dbm) || !std::isfinite(link.time_s) ||
        !link.receiver_m.allFinite() || !link.transmitter_m.allFinite())
      throw Error("a measured signal strength, its time or its positions are not finite");
  }
}

Eigen::Vector2d LogFit::Row(const SignalLink& link) const {
  const double distance = (link.receiver_m - link.transmitter_m).norm();
  return {1, use_distance_ ? std::log10(std::max(kShortestLink_m, distance)) : 0};
}

void LogFit::AddMeasurements(Span<const SignalMeasurement> measurements) {
  CheckMeasurements(measurements);
  for (const SignalMeasurement& measurement : measurements) {
    const Eigen::Vector2d row = Row(measurement.link);
    information_ += row * row.transpose();
    right_hand_side_ += row * measurement.dbm;
    squares_ += measurement.dbm * measurement.dbm;
    ++count_;
  }
}

void LogFit::Update(double) {
  covariance_ = information_.inverse();
  coefficients_ = covariance_ * right_hand_side_;
  if (count_ < 3) return;
  const double sum = squares_ - 2 * coefficients_.dot(right_hand_side_) +
                     coefficients_.dot(information_ * coefficients_);
  sigma_db_ = std::sqrt(std::max(sum / (count_ - 2), 1e-6));
}

void LogFit::Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const {
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Eigen::Vector2d row = Row(links[i]);
    predictions[i] = {row.dot(coefficients_),
                      sigma_db_ * std::sqrt(1 + row.dot(covariance_ * row))};
  }
}

}  // namespace graticule
