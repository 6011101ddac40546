#include "bind.hpp"
#include "graticule/problems/attenuation/tune_method.hpp"
#include "signals.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

using Maps = std::vector<std::shared_ptr<OccupancyGrid>>;

std::vector<TrainingLog> TrainingLogs(std::vector<SignalLog> logs, const Maps& maps) {
  if (!maps.empty() && maps.size() != logs.size())
    throw Error("maps: expected one for each of " + std::to_string(logs.size()) + " logs, found " +
                    std::to_string(maps.size()),
                ErrorKind::kUsage);
  std::vector<TrainingLog> training;
  for (std::size_t i = 0; i < logs.size(); ++i)
    training.push_back({std::move(logs[i]),
                        maps.empty() ? nullptr : maps[i],
                        {},
                        "logs[" + std::to_string(i) + "]"});
  return training;
}

}  // namespace

void BindSignalTuning(py::module_& module) {
  py::enum_<TuneBy>(module, "TuneBy", "What a search for settings makes least.")
      .value("MSE", TuneBy::kMse, "The mean squared error [dB^2].")
      .value("NEGATIVE_LOG_LIKELIHOOD", TuneBy::kNegativeLogLikelihood,
             "Which judges the deviations, too.");
  py::class_<TuneResult, std::shared_ptr<TuneResult>>(
      module, "SignalTuning", "What a search for a method's settings has found.")
      .def_readonly("score", &TuneResult::after, "Mean of the logs' scores with them.")
      .def_readonly("start_score", &TuneResult::before, "Where the search began.")
      .def_property_readonly(
          "settings",
          [](const TuneResult& self) {
            std::map<std::string, double> settings;
            for (std::size_t i = 0; i < self.settings.size(); ++i)
              settings[self.settings[i]->name] = self.search.best[i];
            return settings;
          },
          "As `make_predictor` takes them.")
      .def_property_readonly(
          "evaluations", [](const TuneResult& self) { return self.search.evaluations; },
          "Replays of all logs.")
      .def_property_readonly(
          "has_converged", [](const TuneResult& self) { return self.search.has_converged; },
          "False: max_evaluations came first.");
  module.def(
      "tune_signal",
      [](std::vector<SignalLog> logs, const std::string& method, const Maps& maps,
         const std::map<std::string, double>& settings, const std::vector<std::string>& only,
         TuneBy by, std::size_t max_evaluations, std::size_t threads, const ReplayOptions* options,
         const py::kwargs& keywords) {
        TuneOptions tune;
        tune.by = by;
        tune.replay = OptionsFrom(options, keywords);
        tune.only = only;
        tune.max_evaluations = max_evaluations;
        tune.threads = threads;
        const py::gil_scoped_release released;
        return TuneMethod(method, TrainingLogs(std::move(logs), maps), OptionsOf(settings), tune);
      },
      "logs"_a, "method"_a = kBestMethod, "maps"_a = Maps(),
      "settings"_a = std::map<std::string, double>(), "only"_a = std::vector<std::string>(),
      "by"_a = TuneBy::kMse, "max_evaluations"_a = 200, "threads"_a = 1, "options"_a = nullptr,
      "The settings with which a method predicts recorded logs best, all horizons together, by the "
      "compass search of thesis 3.3.1, as `graticule signal tune`.  maps: one a log, or none; "
      "settings: where the search begins; only: the names of those that are searched, by default "
      "all that the method depends on.  The result does not depend on `threads`.  Options of the "
      "replay also as keywords.");
}

}  // namespace graticule::python
