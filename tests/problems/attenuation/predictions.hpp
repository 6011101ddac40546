#pragma once

#include <vector>

#include "graticule/problems/attenuation/predictor.hpp"

namespace graticule::test {

inline std::vector<SignalLink> LinksOf(const std::vector<SignalMeasurement>& measurements) {
  std::vector<SignalLink> links;
  for (const SignalMeasurement& measurement : measurements) links.push_back(measurement.link);
  return links;
}

inline std::vector<SignalPrediction> Predicted(const SignalPredictor& predictor,
                                               const std::vector<SignalLink>& links) {
  std::vector<SignalPrediction> predictions(links.size());
  predictor.Predict(links, {predictions.data(), predictions.size()});
  return predictions;
}

}  // namespace graticule::test
