#include "signal_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/log_fit.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kMeasured = "graticule-signal-model 1";
constexpr const char* kSchema = "graticule-signal-model/1";

Json ClassesJson(const TomographyOptions& options) {
  Json classes = Json::array();
  for (const AttenuationClass& c : options.classes)
    classes.push_back({{"name", c.name}, {"rho_db_per_m", c.rho_db_per_m}, {"phi", c.phi}});
  return classes;
}

FittedModel ModelOf(const Json& json, const Graph& graph) {
  FittedModel model;
  TomographyOptions& options = model.options;
  options.name = json.at("method").get<std::string>();
  options.classes.clear();
  for (const Json& c : json.at("classes"))
    options.classes.push_back({c.at("name").get<std::string>(), c.at("rho_db_per_m").get<double>(),
                               c.at("phi").get<double>()});
  options.class_of = json.at("class_of").get<std::array<std::uint8_t, 3>>();
  options.uses_map = json.at("uses_map").get<bool>();
  options.cell_m = json.at("cell_m").get<double>();
  options.near_m = json.at("near_m").get<double>();
  options.outside_m = json.at("outside_m").get<double>();
  options.sigma_db = json.at("sigma_db").get<double>();
  options.correlation = json.at("correlation").get<double>();
  options.bias_sigma_db = json.at("bias_sigma_db").get<double>();
  const std::string bias = json.at("bias").get<std::string>();
  options.bias = bias == "none"    ? RadioBias::kNone
                 : bias == "radio" ? RadioBias::kRadio
                                   : RadioBias::kEnds;
  options.Check();
  model.layout.bias = options.bias;
  model.layout.radios = json.at("radios_in_graph").get<std::uint32_t>();
  const auto x0 = json.at("cells").at("x0").get<std::int64_t>();
  const auto y0 = json.at("cells").at("y0").get<std::int64_t>();
  const auto columns = json.at("cells").at("columns").get<std::int64_t>();
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    const Key& key = graph.KeyOf(id);
    for (std::size_t c = 0; c < options.classes.size(); ++c) {
      if (key.Family() != "cell_" + options.classes[c].name) continue;
      if (columns < 1 || key.Number() > 1u << 30) throw Error("cells are not numbered by rows");
      const auto number = static_cast<std::int64_t>(key.Number());
      model.layout.cells.push_back({static_cast<std::uint32_t>(c),
                                    static_cast<std::int32_t>(x0 + number % columns),
                                    static_cast<std::int32_t>(y0 + number / columns)});
      model.layout.cell_keys.push_back(key);
    }
  }
  return model;
}

SignalModel GraphModel(const std::string& path, const std::string& text,
                       const std::shared_ptr<const OccupancyGrid>& map) {
  const Recording recording = ParseRecording(text, path, Builtins());
  const Json json = Json::parse(recording.report, nullptr, false);
  if (!json.is_object() || json.value("schema", "") != kSchema)
    throw Error(path +
                ": a recorded problem, but no signal model: `graticule signal fit` writes "
                "them");
  if (recording.solved_by.empty()) throw Error(path + ": the model is not solved");
  SignalModel model;
  try {
    FittedModel fitted = ModelOf(json, recording.graph);
    model.method = fitted.options.name;
    model.radios = json.at("radios").get<std::vector<std::string>>();
    if (fitted.options.uses_map && !map)
      throw Error("--map: the model's method, " + model.method + ", predicts through a map",
                  ErrorKind::kUsage);
    auto predictor = std::make_unique<FittedTomography>(recording.graph, std::move(fitted));
    model.noise_db = predictor->SigmaDb();
    model.fitted = predictor.get();
    model.predictor = std::move(predictor);
  } catch (const nlohmann::json::exception& exception) {
    throw Error(path + ": not a whole signal model: " + exception.what());
  } catch (const Error& error) {
    if (error.Kind() == ErrorKind::kUsage) throw;
    throw Error(path + ": " + error.what(), error.Kind());
  }
  return model;
}

/// What one measurement's noise is taken to be.
double NoiseOf(const std::string& method, const MethodOptions& options,
               const SignalPredictor& predictor) {
  if (const auto* tomography = dynamic_cast<const Tomography*>(&predictor))
    return tomography->SigmaDb();
  if (const auto* fit = dynamic_cast<const LogFit*>(&predictor)) return fit->SigmaDb();
  if (const auto* process = dynamic_cast<const GaussianProcess*>(&predictor))
    return process->Options().sigma_d_db;
  if (const auto* residual = dynamic_cast<const ResidualGp*>(&predictor))
    return residual->Options().noise_db;
  return method == "persistence" ? options.residual_gp.noise_db : TomographyOptions().sigma_db;
}

SignalModel MeasuredModel(const std::string& path, const std::string& text,
                          const std::shared_ptr<const OccupancyGrid>& map) {
  TextReader reader(text, path);
  MethodOptions options;
  SignalModel model;
  std::size_t lines = 0;
  while (reader.NextLine()) {
    ++lines;
    if (lines == 1) continue;  // the heading
    const std::string word(reader.Word("a word of the model's heading"));
    if (word == "log") break;
    if (word == "method")
      model.method = std::string(reader.Word("the method"));
    else
      SetSignalOption(&options, word, reader.Double("an option's value"));
  }
  if (model.method.empty()) throw Error(path + ": the model's heading names no method");
  // The log begins on the line after; its messages name lines of the file.
  std::size_t begin = 0;
  for (std::size_t i = 0; i < lines && begin != std::string::npos; ++i)
    begin = text.find('\n', begin + (i > 0));
  if (begin == std::string::npos) throw Error(path + ": the model ends before its log");
  const std::string blanks(lines, '\n');
  const SignalLog log = ParseSignalLog(blanks + text.substr(begin + 1), path);
  model.radios = log.radios;
  model.predictor = MakePredictor(model.method, options);
  if (NeedsMap(model.method) && !map)
    throw Error("--map: the model's method, " + model.method + ", predicts through a map",
                ErrorKind::kUsage);
  if (UsesMap(model.method)) model.predictor->SetMap(map);
  model.predictor->AddMeasurements(log.measurements);
  if (!log.measurements.empty()) model.now_s = log.measurements.back().link.time_s;
  model.predictor->Update(model.now_s);
  model.noise_db = NoiseOf(model.method, options, *model.predictor);
  return model;
}

}  // namespace

std::uint32_t SignalModel::RadioOf(const std::string& name) const {
  const auto found = std::find(radios.begin(), radios.end(), name);
  return static_cast<std::uint32_t>(found - radios.begin());
}

SignalModel LoadSignalModel(const std::string& path, const std::string& map_path) {
  const std::string text = ReadFile(path);
  const std::shared_ptr<const OccupancyGrid> map = LoadMap(map_path);
  if (text.compare(0, kMeasured.size(), kMeasured) == 0) return MeasuredModel(path, text, map);
  if (text.compare(0, 17, "graticule-problem") != 0)
    throw Error(path, 1, 1,
                "expected a signal model: 'graticule-problem' or 'graticule-signal-model'");
  SignalModel model = GraphModel(path, text, map);
  if (map) model.predictor->SetMap(map);
  return model;
}

std::string ModelLine(const FittedModel& model, const std::vector<std::string>& radios) {
  const TomographyOptions& options = model.options;
  std::int32_t x0 = 0, y0 = 0, x1 = 0;
  for (std::size_t i = 0; i < model.layout.cells.size(); ++i) {
    const AttenuationCell& cell = model.layout.cells[i];
    x0 = i == 0 ? cell.x : std::min(x0, cell.x);
    x1 = i == 0 ? cell.x : std::max(x1, cell.x);
    y0 = i == 0 ? cell.y : std::min(y0, cell.y);
  }
  const Json json = {{"schema", kSchema},
                     {"method", options.name},
                     {"radios", radios},
                     {"radios_in_graph", model.layout.radios},
                     {"classes", ClassesJson(options)},
                     {"class_of", options.class_of},
                     {"uses_map", options.uses_map},
                     {"cell_m", options.cell_m},
                     {"cells", {{"x0", x0}, {"y0", y0}, {"columns", x1 - x0 + 1}}},
                     {"near_m", options.near_m},
                     {"outside_m", options.outside_m},
                     {"bias", options.bias == RadioBias::kNone    ? "none"
                              : options.bias == RadioBias::kRadio ? "radio"
                                                                  : "ends"},
                     {"bias_sigma_db", options.bias_sigma_db},
                     {"sigma_db", options.sigma_db},
                     {"correlation", options.correlation}};
  return json.dump();
}

std::string FormatMeasuredModel(const std::string& method, const MethodOptions& options,
                                const SignalLog& log) {
  std::string text = std::string(kMeasured) + "\nmethod " + method + "\n";
  for (const SignalSetting* setting : SettingsOf(method)) {
    text += setting->name + " ";
    AppendNumber(&text, setting->get(options));
    text += "\n";
  }
  return text + "log\n" + FormatSignalLog(log);
}

}  // namespace graticule::apps
