#include "bind.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/plan.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "signals.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

using Predictions = std::pair<py::array_t<double>, py::array_t<double>>;

// dbm and sigma_db of links.
Predictions Predicted(const SignalPredictor& predictor, const std::vector<SignalLink>& links) {
  std::vector<SignalPrediction> predictions(links.size());
  {
    const py::gil_scoped_release released;
    predictor.Predict(links, {predictions.data(), predictions.size()});
  }
  std::vector<double> dbm, sigma_db;
  for (const SignalPrediction& prediction : predictions) {
    dbm.push_back(prediction.dbm);
    sigma_db.push_back(prediction.sigma_db);
  }
  return {Owned(std::move(dbm)), Owned(std::move(sigma_db))};
}

void BindPredictor(py::module_& m) {
  py::class_<SignalPredictor, std::shared_ptr<SignalPredictor>>(
      m, "SignalPredictor",
      "A way to predict signal strength, which learns as measurements come (thesis 3.2).  The "
      "same calls give the same digits.")
      .def(
          "set_map",
          [](SignalPredictor& self, std::shared_ptr<OccupancyGrid> map) {
            self.SetMap(std::move(map));
          },
          "map"_a, py::call_guard<py::gil_scoped_release>(),
          "What lies between radios; from then on for old measurements as well.")
      .def(
          "add_measurements",
          [](SignalPredictor& self, const SignalLog& log) {
            self.AddMeasurements(log.measurements);
          },
          "log"_a, Released(), "In the order of time.")
      .def("update", &SignalPredictor::Update, "now_s"_a, Released(),
           "Learns from what was added, up to this time [s].")
      .def(
          "predict",
          [](const SignalPredictor& self, const SignalLog& log) {
            return Predicted(self, LinksOf(log));
          },
          "log"_a,
          "Of a log's links: (n,) strength [dBm] and (n,) its standard deviation [dB], noise of "
          "the measurement included.")
      .def(
          "predict_links",
          [](const SignalPredictor& self, const Dense<double>& receivers_m,
             const Dense<double>& transmitters_m,
             const std::optional<Dense<std::int64_t>>& receivers,
             const std::optional<Dense<std::int64_t>>& transmitters,
             const std::optional<Dense<double>>& times_s) {
            return Predicted(
                self, LinksOf(receivers_m, transmitters_m, receivers, transmitters, times_s));
          },
          "receivers_m"_a, "transmitters_m"_a, "receivers"_a = py::none(),
          "transmitters"_a = py::none(), "times_s"_a = py::none(),
          "The same of links between places, (n, 2) or (n, 3) in the map's frame [m]; receivers, "
          "transmitters: (n,) the radios' numbers, None: 0 and 1.")
      .def_property_readonly("name", &SignalPredictor::Name, "\"matte\"");
  m.def("method_names", &MethodNames, "The methods that there are.");
  m.def(
      "signal_settings",
      [](const std::string& method) {
        py::dict settings;
        const MethodOptions defaults;
        for (const SignalSetting* setting : SettingsOf(method))
          settings[py::str(setting->name)] = setting->get(defaults);
        return settings;
      },
      "method"_a, "A method's settings, with their defaults.");
  m.attr("best_method") = kBestMethod;
  m.def(
      "make_predictor",
      [](const std::string& name, const std::map<std::string, double>& settings) {
        return std::shared_ptr<SignalPredictor>(MakePredictor(name, OptionsOf(settings)));
      },
      "name"_a = kBestMethod, "settings"_a = std::map<std::string, double>(),
      "A predictor by its method's name.  settings: as `signal_settings` has them.");
}

void BindScores(py::module_& m) {
  Record<SignalScore>(m, "SignalScore", "How well predictions came true.")
      .Result("count", &SignalScore::count, "Predictions.")
      .Result("mse", &SignalScore::mse, "[dB^2]")
      .Result("rmse", &SignalScore::rmse, "[dB]")
      .Result("standard_error", &SignalScore::standard_error, "Of mse.")
      .Result("negative_log_likelihood", &SignalScore::negative_log_likelihood, "A prediction's.")
      .Result("crps", &SignalScore::crps, "Continuous ranked probability score [dB].")
      .Result("coverage", &SignalScore::coverage,
              "(4,) share within the central 50, 68, 90 and 95 % intervals.");
  Record<ReplayOptions>(m, "ReplayOptions", "How a log is replayed.")
      .Field("step_s", &ReplayOptions::step_s, "[s]")
      .Field("horizons", &ReplayOptions::horizons, "Of step_s each.")
      .Field("new_drive_s", &ReplayOptions::new_drive_s, "A pause this long ends a drive [s].")
      .Field("forget_between_drives", &ReplayOptions::forget_between_drives,
             "Learns each drive from nothing.")
      .Field("every", &ReplayOptions::every, "Predicts at each so many'th step only.");
  Record<ReplayResult>(m, "ReplayResult", "A method on a log.")
      .Result("method", &ReplayResult::method, "Its name.")
      .Result("horizons", &ReplayResult::horizons, "Scores, the nearest first.")
      .Result("all", &ReplayResult::all, "All of them together.")
      .Result("update_ms", &ReplayResult::update_ms, "Wall, a step, mean.")
      .Result("predict_ms", &ReplayResult::predict_ms, "Wall, a step, mean.");
  m.def(
      "replay_signal",
      [](const SignalLog& log, const std::string& method, const std::shared_ptr<OccupancyGrid>& map,
         const std::map<std::string, double>& settings, const ReplayOptions* options,
         const py::kwargs& keywords) {
        const ReplayOptions chosen = OptionsFrom(options, keywords);
        const MethodOptions made = OptionsOf(settings);
        const py::gil_scoped_release released;
        return Replay(
            log,
            [&] {
              auto predictor = MakePredictor(method, made);
              if (map) predictor->SetMap(map);
              return predictor;
            },
            chosen);
      },
      "log"_a, "method"_a = kBestMethod, "map"_a = nullptr,
      "settings"_a = std::map<std::string, double>(), "options"_a = nullptr,
      "The prequential replay of thesis 3.3.1: after each step the method predicts what comes, "
      "and then learns from it.  Options also as keywords.");
  py::class_<HoldOut>(m, "HoldOut", "Which measurements are learnt from, and which predicted.")
      .def_readonly("train", &HoldOut::train, "(n,) rows of the log.")
      .def_readonly("test", &HoldOut::test, "(n,) rows of the log.");
  m.def("random_links", &RandomLinks, "log"_a, "part"_a, "seed"_a = 1,
        "Links at random, this part of them to predict.");
  m.def("unseen_radios", &UnseenRadios, "log"_a, "part"_a, "seed"_a = 1, "unseen_ends"_a = 1,
        "This part of all radios is never heard of in training.");
  m.def("frontier_sweep", &FrontierSweep, "log"_a, "count"_a,
        "A frontier that sweeps the map along x.");
  m.def(
      "evaluate_hold_out",
      [](const SignalLog& log, const std::vector<HoldOut>& splits, const std::string& method,
         const std::shared_ptr<OccupancyGrid>& map, const std::map<std::string, double>& settings) {
        const MethodOptions made = OptionsOf(settings);
        const py::gil_scoped_release released;
        return EvaluateHoldOut(log, splits, [&] {
          auto predictor = MakePredictor(method, made);
          if (map) predictor->SetMap(map);
          return predictor;
        });
      },
      "log"_a, "splits"_a, "method"_a = kBestMethod, "map"_a = nullptr,
      "settings"_a = std::map<std::string, double>(),
      "Learns from one part and predicts the other, for each split.");
}

void BindPlanning(py::module_& m) {
  Record<TeamLink>(m, "TeamLink", "Two radios of a team, and how well they hear each other.")
      .Result("a", &TeamLink::a, "A radio's number.")
      .Result("b", &TeamLink::b, "A radio's number.")
      .Result("probability", &TeamLink::probability, "That the strength is usable.")
      .Class()
      .def_property_readonly(
          "dbm", [](const TeamLink& link) { return link.prediction.dbm; },
          "Predicted strength, the mean of both ways [dBm].")
      .def_property_readonly(
          "sigma_db", [](const TeamLink& link) { return link.prediction.sigma_db; },
          "Its standard deviation [dB].");
  Record<TeamConnectivity>(m, "TeamConnectivity", "Who can talk to whom.")
      .Result("links", &TeamConnectivity::links, "Every pair.")
      .Result("connected", &TeamConnectivity::connected,
              "Probability that links which are up join the whole team.")
      .Result("backbone", &TeamConnectivity::backbone,
              "(n,) the links without which nobody is left out, the likeliest.");
  m.def("connect", &Connect, "predictor"_a, "radios"_a, "at_m"_a, "usable_dbm"_a, "now_s"_a,
        "The team's connectivity graph: radios: (n,) numbers; at_m: n places (3,) [m]; now_s: the "
        "time asked for, not before what was learnt.");
  Record<WorthwhilePlace>(m, "WorthwhilePlace", "A place to measure from.")
      .Result("at_m", &WorthwhilePlace::at_m, "(3,) in the map's frame [m].")
      .Result("gain_nats", &WorthwhilePlace::gain_nats,
              "What one measurement to each of the others tells about the model [nats].")
      .Result("sigma_db", &WorthwhilePlace::sigma_db,
              "The largest predicted deviation among those [dB].");
  m.def("where_to_measure", &WhereToMeasure, "predictor"_a, "noise_db"_a, "now_s"_a, "radio"_a,
        "others"_a, "others_m"_a, "candidates_m"_a, "count"_a = 5, Released(),
        "Where a robot should measure next, the best first, each as if those before had been "
        "measured (greedy).  The predictor learns the imagined measurements: make one for this.  "
        "noise_db: of one measurement [dB]; now_s: not before the last that was learnt [s]; radio: "
        "the robot's number; others, others_m: (n,) numbers and n places (3,) [m] of the rest; "
        "candidates_m: places (3,) that it may go to [m].");
}

}  // namespace

void BindAttenuation(py::module_& module) {
  BindPredictor(module);
  BindScores(module);
  BindPlanning(module);
}

}  // namespace graticule::python
