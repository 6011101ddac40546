#include <cmath>

#include "bind.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/tune.hpp"
#include "signals.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

using Maps = std::vector<std::shared_ptr<OccupancyGrid>>;

/// What a search has found.
struct SignalTuning {
  std::map<std::string, double> settings;
  double mse = 0, start_mse = 0;
  std::size_t evaluations = 0;
  bool has_converged = false;
};

// Over all predictions of all logs [dB^2].
double MeanSquaredError(const std::vector<SignalLog>& logs, const Maps& maps,
                        const std::string& method, const MethodOptions& options,
                        const ReplayOptions& replay) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const auto make = [&] {
      auto predictor = MakePredictor(method, options);
      if (!maps.empty() && maps[i]) predictor->SetMap(maps[i]);
      return predictor;
    };
    const SignalScore score = Replay(logs[i], make, replay).all;
    const auto predictions = static_cast<double>(score.count);
    if (predictions > 0) sum += score.mse * predictions;
    count += predictions;
  }
  return count > 0 ? sum / count : std::nan("");
}

SignalTuning Tune(const std::vector<SignalLog>& logs, const std::string& method, const Maps& maps,
                  const std::map<std::string, double>& settings, const ReplayOptions& replay,
                  std::size_t max_evaluations, std::size_t threads) {
  const std::vector<const SignalSetting*> searched = SettingsOf(method);
  if (searched.empty()) throw Error(method + " has nothing to tune", ErrorKind::kUsage);
  if (logs.empty()) throw Error("logs: expected one at least", ErrorKind::kUsage);
  if (!maps.empty() && maps.size() != logs.size())
    throw Error("maps: expected one for each of " + std::to_string(logs.size()) + " logs, found " +
                    std::to_string(maps.size()),
                ErrorKind::kUsage);
  const MethodOptions from = OptionsOf(settings);
  CompassOptions search;
  std::vector<double> start;
  for (const SignalSetting* setting : searched) {
    start.push_back(setting->get(from));
    search.scale.push_back(setting->step);
    search.lower.push_back(setting->lower);
    search.upper.push_back(setting->upper);
  }
  search.last_step = 0.2;  // as the program's
  search.max_evaluations = max_evaluations;
  search.threads = threads;
  const CompassResult found = CompassSearch(
      [&](const std::vector<double>& numbers) {
        MethodOptions tried = from;
        for (std::size_t i = 0; i < searched.size(); ++i) searched[i]->set(&tried, numbers[i]);
        return MeanSquaredError(logs, maps, method, tried, replay);
      },
      start, search);
  SignalTuning tuning;
  for (std::size_t i = 0; i < searched.size(); ++i)
    tuning.settings[searched[i]->name] = found.best[i];
  tuning.mse = found.value;
  tuning.start_mse = found.start_value;
  tuning.evaluations = found.evaluations;
  tuning.has_converged = found.has_converged;
  return tuning;
}

}  // namespace

void BindSignalTuning(py::module_& module) {
  Record<SignalTuning>(module, "SignalTuning", "What a search for a method's settings has found.")
      .Result("settings", &SignalTuning::settings, "As `make_predictor` takes them.")
      .Result("mse", &SignalTuning::mse, "Mean squared error with them [dB^2].")
      .Result("start_mse", &SignalTuning::start_mse, "Where the search began [dB^2].")
      .Result("evaluations", &SignalTuning::evaluations, "Replays of all logs.")
      .Result("has_converged", &SignalTuning::has_converged, "False: max_evaluations came first.");
  module.def(
      "tune_signal",
      [](const std::vector<SignalLog>& logs, const std::string& method, const Maps& maps,
         const std::map<std::string, double>& settings, std::size_t max_evaluations,
         std::size_t threads, const ReplayOptions* options, const py::kwargs& keywords) {
        const ReplayOptions replay = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        return Tune(logs, method, maps, settings, replay, max_evaluations, threads);
      },
      "logs"_a, "method"_a = kBestMethod, "maps"_a = Maps(),
      "settings"_a = std::map<std::string, double>(), "max_evaluations"_a = 200, "threads"_a = 1,
      "options"_a = nullptr,
      "The settings with which a method predicts recorded logs with the least mean squared error, "
      "all horizons together, by the compass search of thesis 3.3.1, as `graticule signal tune`.  "
      "maps: one a log, or none; settings: where the search begins.  The result does not depend "
      "on `threads`.  Options of the replay also as keywords.");
}

}  // namespace graticule::python
