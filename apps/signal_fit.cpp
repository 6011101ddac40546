#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/attenuation/fitted.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/solver/provenance.hpp"
#include "graticule/solver/solve.hpp"
#include "problem.hpp"
#include "signal_input.hpp"
#include "signal_model.hpp"

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

/// Null for methods that are no graph.
const TomographyOptions* GraphOptions(const std::string& method, const MethodOptions& options) {
  static const TomographyOptions log_fit = TomographyOptions::LogFit();
  if (method == "log-fit") return &log_fit;
  if (method == "one-attenuation-a-class") return &options.one_a_class;
  if (method == "mrt") return &options.mrt;
  if (method == "matte") return &options.matte;
  if (method == "fine-mrt") return &options.fine_mrt;
  return nullptr;
}

/// What the log leaves as it was believed.
std::vector<std::string> NotDeterminedBy(const LoadedSignal& signal,
                                         const TomographyOptions& options) {
  Tomography learnt(options);
  if (signal.map) learnt.SetMap(signal.map);
  learnt.AddMeasurements(signal.log.measurements);
  learnt.Update(signal.log.measurements.back().link.time_s);
  return learnt.NotDetermined();
}

void Say(const std::vector<std::string>& not_determined, const LoadedSignal& signal,
         const Console& console) {
  for (const std::string& what : not_determined)
    console.Note(signal.name + ": not determined: " + what);
}

int FitGraph(const SignalFitCommand& command, const LoadedSignal& signal,
             const TomographyOptions& options, const Console& console) {
  FittedGraph built =
      About(signal.name, [&] { return BuildFitted(signal.log, signal.map, options); });
  Say(built.not_determined, signal, console);

  Recording recording(Builtins());
  recording.graph = std::move(built.graph);
  recording.title = "signal strength, " + options.name;
  recording.made_by = MadeBy("signal fit " + signal.name + " --method " + options.name);
  recording.frames = "map";
  WriteOptions writing;
  writing.binary = command.binary;
  if (!command.record.empty()) WriteProblem(command.record, recording, writing);

  // From here on Ctrl-C ends the solve, and does not cut a file that is being written.
  const Interruptible interruptible;
  const Solution solution =
      Solve(recording.graph, TomographySolving(), Watch(console, signal.name));
  console.Progress("");
  if (solution.report.termination == Termination::kFailed)
    throw Error(signal.name + ": " + solution.report.message, ErrorKind::kOther);
  recording.graph.SetValues(solution.values);
  recording.solved_by =
      fmt::format("graticule {}: {}", Version(), ToString(solution.report.termination));
  recording.report = ModelLine(built.model, signal.log.radios);
  WriteProblem(command.output, recording, writing);

  const TomographyEstimate estimate = ReadBackTomography(built.model.layout, solution.values);
  Json json = {{"schema", "graticule-signal-fit/1"},
               {"method", options.name},
               {"measurements", signal.log.measurements.size()},
               {"termination", ToString(solution.report.termination)},
               {"cost", solution.report.final_cost},
               {"l0_dbm", estimate.l0_dbm},
               {"slope_db", estimate.slope_db},
               {"noise_db", built.model.options.sigma_db},
               {"cells", built.model.layout.cells.size()},
               {"classes", Json::array()},
               {"not_determined", built.not_determined}};
  for (std::size_t r = 0; r < estimate.receiver_bias_db.size(); ++r)
    json["bias_db"][signal.log.radios[r]] = {{"receiving", estimate.receiver_bias_db[r]},
                                             {"sending", estimate.transmitter_bias_db[r]}};
  for (std::size_t c = 0; c < options.classes.size(); ++c) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < estimate.db_per_m.size(); ++i)
      if (built.model.layout.cells[i].material == c) {
        sum += estimate.db_per_m[i];
        ++count;
      }
    json["classes"].push_back({{"name", options.classes[c].name},
                               {"cells", count},
                               {"mean_db_per_m", count > 0 ? Json(sum / count) : Json()}});
  }
  if (command.json) {
    fmt::print("{}\n", JsonText(json, 1));
  } else {
    fmt::print(
        "{}: {} measurements, {}: {}\n  path loss     {:.2f} dBm at 1 m, {:.2f} dB a decade\n"
        "  noise         {:.2f} dB\n",
        signal.name, signal.log.measurements.size(), options.name,
        ToString(solution.report.termination), estimate.l0_dbm, estimate.slope_db,
        built.model.options.sigma_db);
    for (const Json& c : json["classes"])
      if (c["cells"] > 0)
        fmt::print("  {:<13} {:.3f} dB/m, mean of {} cells\n", c["name"].get<std::string>(),
                   c["mean_db_per_m"].get<double>(), c["cells"].get<int>());
    for (std::size_t r = 0; r < estimate.receiver_bias_db.size(); ++r)
      fmt::print("  {:<13} {:+.2f} dB\n", signal.log.radios[r], estimate.receiver_bias_db[r]);
    fmt::print("  wrote         {}\n", command.output);
  }
  return ExitOf(solution.report.termination);
}

}  // namespace

int Run(const SignalFitCommand& command, const Console& console) {
  const std::string method = MethodOf(command.method);
  const MethodOptions options = OptionsOf(command.choosing);
  const TomographyOptions* graph = GraphOptions(method, options);
  if (graph != nullptr) ExpectEnding(command.output, "--output", {".fg"});
  if (!command.record.empty()) {
    if (graph == nullptr)
      throw Error("--record: " + method + " is no factor graph", ErrorKind::kUsage);
    ExpectEnding(command.record, "--record", {".fg"});
    ExpectWritable(command.record);
  }
  ExpectWritable(command.output);
  if (command.input.logs.size() != 1) throw Error("signal fit takes one log", ErrorKind::kUsage);
  const LoadedSignal signal = LoadSignals(command.input).front();
  if (signal.log.measurements.empty()) throw Error(signal.name + ": no measurement");
  if (NeedsMap(method) && !signal.map)
    throw Error("--map: " + method + " needs the map that the log's positions are in",
                ErrorKind::kUsage);
  if (graph != nullptr) return FitGraph(command, signal, *graph, console);

  // What it learns is checked now; what it keeps is what was measured.
  auto predictor = MakePredictor(method, options);
  About(signal.name, [&] {
    if (UsesMap(method)) predictor->SetMap(signal.map);
    predictor->AddMeasurements(signal.log.measurements);
    predictor->Update(signal.log.measurements.back().link.time_s);
    return 0;
  });
  // Beneath a process there is a graph's model, or at least the path loss; a mean has neither.
  const TomographyOptions* mean = GraphOptions(method.substr(0, method.find('+')), options);
  if (mean == nullptr) mean = GraphOptions("log-fit", options);
  std::vector<std::string> not_determined;
  if (method != "mean") not_determined = NotDeterminedBy(signal, *mean);
  Say(not_determined, signal, console);
  WriteFile(command.output, FormatMeasuredModel(method, options, signal.log));
  if (command.json)
    fmt::print("{}\n", JsonText(Json{{"schema", "graticule-signal-fit/1"},
                                     {"method", method},
                                     {"measurements", signal.log.measurements.size()},
                                     {"not_determined", not_determined}},
                                1));
  else
    fmt::print("{}: {} measurements, {}\n  wrote         {}\n", signal.name,
               signal.log.measurements.size(), method, command.output);
  return kDone;
}

}  // namespace graticule::apps
