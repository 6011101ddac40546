#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graticule/io/recording.hpp"
#include "graticule/problems/attenuation/fitted.hpp"
#include "graticule/problems/attenuation/predictor.hpp"
#include "signal_input.hpp"

namespace graticule::apps {

/// What `signal fit` has written: a solved factor graph, or what was measured (docs/signal.md).
struct SignalModel {
  std::string method;
  std::vector<std::string> radios;
  std::unique_ptr<SignalPredictor> predictor;  ///< with the map
  /// The same, where the model is a graph; else null.
  const FittedTomography* fitted = nullptr;
  double noise_db = 0;  ///< of one measurement
  double now_s = 0;     ///< of the last measurement; 0 where the model is a graph, without time

  /// The number of a radio; of one that the model has never heard of one beyond all.
  std::uint32_t RadioOf(const std::string& name) const;
};

/// Throws Error: a file that is no model, a map that is needed and not given (kUsage).
SignalModel LoadSignalModel(const std::string& path, const std::string& map);
/// The same of the file's text; `map` may be null.
SignalModel ParseSignalModel(const std::string& text, const std::string& path,
                             const std::shared_ptr<const OccupancyGrid>& map);

/// The line that a model's recording carries, in `report`.
std::string ModelLine(const FittedModel& model, const std::vector<std::string>& radios);

/// The model of a method that keeps what was measured: a heading and the log.
std::string FormatMeasuredModel(const std::string& method, const MethodOptions& options,
                                const SignalLog& log);

}  // namespace graticule::apps
