#include "graticule/problems/attenuation/log_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// One measurement's deviation as first believed, and how many measurements that is worth: a few
// that are alike by chance are no proof that all are.  As TomographyOptions has them.
constexpr double kSigma_db = 5, kSigmaWeight = 5;

}  // namespace

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
  const double sum = squares_ - 2 * coefficients_.dot(right_hand_side_) +
                     coefficients_.dot(information_ * coefficients_);
  sigma_db_ = std::sqrt((kSigmaWeight * kSigma_db * kSigma_db + std::max(0.0, sum)) /
                        (kSigmaWeight + std::max(0.0, count_ - 2)));
}

void LogFit::Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const {
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Eigen::Vector2d row = Row(links[i]);
    predictions[i] = {row.dot(coefficients_),
                      sigma_db_ * std::sqrt(1 + row.dot(covariance_ * row))};
  }
}

}  // namespace graticule
