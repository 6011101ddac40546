#include "fuzz.hpp"
#include "signal_model.hpp"

// A model of either kind, and what it predicts of one link.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  const apps::SignalModel model = apps::ParseSignalModel(std::string(text), "fuzz.fg", nullptr);
  SignalLink link;
  link.transmitter = 1;
  link.transmitter_m = {3, 4, 0};
  SignalPrediction prediction;
  model.predictor->Predict({&link, 1}, {&prediction, 1});
}
