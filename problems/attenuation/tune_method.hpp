#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/io/signal_log.hpp"
#include "graticule/problems/attenuation/growing_map.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "graticule/problems/attenuation/tune.hpp"

namespace graticule {

/// A log to tune on, and the map that came with it (null: none), or as it grew.
struct TrainingLog {
  SignalLog log;
  std::shared_ptr<const OccupancyGrid> map;
  std::vector<TimedMap> maps = {};
  std::string name = {};  ///< in messages
};

enum class TuneBy { kMse, kNegativeLogLikelihood };

struct TuneOptions {
  TuneBy by = TuneBy::kNegativeLogLikelihood;
  ReplayOptions replay;
  std::vector<std::string> only;  ///< names of settings; empty: SettingsOf the method
  /// Of each setting's own first step.
  double first_step = 1, last_step = 0.25;
  std::size_t max_evaluations = 200, threads = 1;
  std::string state_path;  ///< as CompassOptions has it; refused for other logs, too
  /// Who finds the scores of settings' values in the order of TunedSettings, for instance other
  /// processes by TuneScore; empty: this one, by `threads`.
  CompassEvaluate evaluate;
};

struct TuneResult {
  MethodOptions options;
  std::vector<const SignalSetting*> settings;  ///< those that were searched
  double before = 0, after = 0;                ///< mean of the logs' scores, all horizons together
  CompassResult search;                        ///< its best: values of the settings
};

/// The settings that TuneMethod searches.  Throws Error (kUsage): no such method or setting, none.
std::vector<const SignalSetting*> TunedSettings(const std::string& method,
                                                const MethodOptions& start,
                                                const TuneOptions& options);

/// How well a method predicts the logs: the mean of their mean squared errors [dB^2] or negative
/// log likelihoods; less is better.  Throws what Replay throws, and Error (kInput): a log in which
/// nothing is predicted.
double TuneScore(const std::string& method, const std::vector<TrainingLog>& logs,
                 const MethodOptions& method_options, const TuneOptions& options);

/// Compass search (thesis 3.3.1) for the settings with which a method predicts recorded logs best,
/// in the replay's way.  Throws Error (kUsage): no log; and what TunedSettings, TuneScore and
/// CompassSearch throw.
TuneResult TuneMethod(const std::string& method, const std::vector<TrainingLog>& logs,
                      const MethodOptions& start, const TuneOptions& options);

}  // namespace graticule
