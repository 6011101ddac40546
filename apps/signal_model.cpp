#include "signal_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_document.hpp"
#include "graticule/io/json_text.hpp"
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

constexpr long kMost = 1 << 30;  // cells a side, or radios

std::vector<std::string> RadiosOf(const JsonPlace& list) {
  std::vector<std::string> radios;
  for (std::size_t i = 0; i < list.Size(); ++i) radios.push_back(list.At(i).Text());
  return radios;
}

TomographyOptions OptionsOf(const JsonPlace& json) {
  TomographyOptions options;
  options.name = json["method"].Text();
  options.classes.clear();
  const JsonPlace classes = json["classes"];
  for (std::size_t i = 0; i < classes.Size(); ++i) {
    const JsonPlace c = classes.At(i);
    options.classes.push_back({c["name"].Text(), c["rho_db_per_m"].Number(), c["phi"].Number()});
  }
  const JsonPlace class_of = json["class_of"];
  class_of.OfSize(options.class_of.size());
  for (std::size_t i = 0; i < options.class_of.size(); ++i)
    options.class_of[i] = static_cast<std::uint8_t>(class_of.At(i).Integer(0, 255));
  options.uses_map = json["uses_map"].Flag();
  options.cell_m = json["cell_m"].Number();
  options.near_m = json["near_m"].Number();
  options.outside_m = json["outside_m"].Number();
  options.sigma_db = json["sigma_db"].Number();
  options.correlation = json["correlation"].Number();
  options.bias_sigma_db = json["bias_sigma_db"].Number();
  const std::string bias = json["bias"].Text();
  options.bias = bias == "none"    ? RadioBias::kNone
                 : bias == "radio" ? RadioBias::kRadio
                                   : RadioBias::kEnds;
  options.Check();
  return options;
}

FittedModel ModelOf(const JsonPlace& json, const Graph& graph) {
  FittedModel model;
  model.options = OptionsOf(json);
  model.layout.bias = model.options.bias;
  model.layout.radios = static_cast<std::uint32_t>(json["radios_in_graph"].Integer(0, kMost));
  const JsonPlace cells = json["cells"];
  const long x0 = cells["x0"].Integer(-kMost, kMost);
  const long y0 = cells["y0"].Integer(-kMost, kMost);
  const long columns = cells["columns"].Integer(0, kMost);
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    const Key& key = graph.KeyOf(id);
    for (std::size_t c = 0; c < model.options.classes.size(); ++c) {
      if (key.Family() != "cell_" + model.options.classes[c].name) continue;
      if (columns < 1 || key.Number() >= kMost) cells.Fail("cells are not numbered by rows");
      const auto number = static_cast<long>(key.Number());
      model.layout.cells.push_back({static_cast<std::uint32_t>(c),
                                    static_cast<std::int32_t>(x0 + number % columns),
                                    static_cast<std::int32_t>(y0 + number / columns)});
      model.layout.cell_keys.push_back(key);
    }
  }
  return model;
}

[[noreturn]] void AskForMap(const std::string& method) {
  throw Error("--map: the model's method, " + method + ", predicts through a map",
              ErrorKind::kUsage);
}

SignalModel GraphModel(const std::string& path, const std::string& text,
                       const std::shared_ptr<const OccupancyGrid>& map) {
  const Recording recording = ParseRecording(text, path, Builtins());
  const std::string no_model =
      path + ": a recorded problem, but no signal model: `graticule signal fit` writes them";
  if (recording.report.empty()) throw Error(no_model);
  const JsonDocument report(recording.report, path + ": report");
  const JsonPlace json = report.Root();
  if (!json.Has("schema") || !json["schema"].IsText() || json["schema"].Text() != kSchema)
    throw Error(no_model);
  if (recording.solved_by.empty()) throw Error(path + ": the model is not solved");
  FittedModel fitted = ModelOf(json, recording.graph);
  SignalModel model;
  model.method = fitted.options.name;
  model.radios = RadiosOf(json["radios"]);
  if (fitted.options.uses_map && !map) AskForMap(model.method);
  auto predictor = std::make_unique<FittedTomography>(recording.graph, std::move(fitted));
  model.noise_db = predictor->SigmaDb();
  model.fitted = predictor.get();
  model.predictor = std::move(predictor);
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
  if (const auto* combination = dynamic_cast<const Combination*>(&predictor)) {
    double variance = 0;
    for (std::size_t k = 0; k < combination->Now().size(); ++k) {
      const double noise = NoiseOf(method, options, *combination->Now()[k]);
      variance += combination->NearWeights()[static_cast<Eigen::Index>(k)] * noise * noise;
    }
    return combination->NearScale() * std::sqrt(variance);
  }
  return method == "persistence" ? options.residual_gp.noise_db : TomographyOptions().sigma_db;
}

// The heading; the reader is then behind the word that the log begins after.
void ReadHeading(TextReader* reader, SignalModel* model, MethodOptions* options) {
  reader->NextLine();  // the kind of file
  while (reader->NextLine()) {
    const std::string word(reader->Word("a word of the model's heading"));
    if (word == "log") {
      reader->ExpectEnd();
      if (model->method.empty()) reader->Fail("the model's heading names no method");
      return;
    }
    if (word == "method") {
      model->method = std::string(reader->Word("the method"));
    } else {
      const double value = reader->Double("an option's value");
      try {
        SetSignalOption(options, word, value);
      } catch (const Error& error) {
        reader->Fail(error.what());
      }
    }
    reader->ExpectEnd();
  }
  reader->FailAt(reader->Size(), "the model ends before its log");
}

SignalModel MeasuredModel(const std::string& path, const std::string& text,
                          const std::shared_ptr<const OccupancyGrid>& map) {
  TextReader reader(text, path);
  MethodOptions options;
  SignalModel model;
  ReadHeading(&reader, &model, &options);
  // The log begins on the line after; its messages name lines of the file.
  const std::size_t begin = std::min(text.find('\n', reader.Offset()), text.size());
  const std::string blanks(reader.LineNumber(reader.LineOffset()), '\n');
  const SignalLog log =
      ParseSignalLog(blanks + text.substr(std::min(begin + 1, text.size())), path);
  model.radios = log.radios;
  model.predictor = MakePredictor(model.method, options);
  if (NeedsMap(model.method) && !map) AskForMap(model.method);
  if (UsesMap(model.method)) model.predictor->SetMap(map);
  model.predictor->AddMeasurements(log.measurements);
  if (!log.measurements.empty()) model.now_s = log.measurements.back().link.time_s;
  model.predictor->Update(model.now_s);
  model.noise_db = NoiseOf(model.method, options, *model.predictor);
  return model;
}

// What is wrong with a model is wrong with its file, not with how the program was called; but a map
// that is missing is.
template <class Parse>
SignalModel OfFile(const std::string& path, const Parse& parse) {
  try {
    return parse();
  } catch (const Error& error) {
    const std::string what = error.what();
    if (what.rfind("--map", 0) == 0 || what.rfind(path + ":", 0) == 0) throw;
    throw Error(path + ": " + what,
                error.Kind() == ErrorKind::kUsage ? ErrorKind::kInput : error.Kind());
  }
}

}  // namespace

std::uint32_t SignalModel::RadioOf(const std::string& name) const {
  const auto found = std::find(radios.begin(), radios.end(), name);
  return static_cast<std::uint32_t>(found - radios.begin());
}

SignalModel LoadSignalModel(const std::string& path, const std::string& map_path) {
  const std::string text = ReadFile(path);
  return ParseSignalModel(text, path, LoadMap(map_path));
}

SignalModel ParseSignalModel(const std::string& text, const std::string& path,
                             const std::shared_ptr<const OccupancyGrid>& map) {
  if (text.compare(0, kMeasured.size(), kMeasured) == 0)
    return OfFile(path, [&] { return MeasuredModel(path, text, map); });
  if (text.compare(0, 17, "graticule-problem") != 0)
    throw Error(path, 1, 1,
                "expected a signal model: 'graticule-problem' or 'graticule-signal-model'");
  SignalModel model = OfFile(path, [&] { return GraphModel(path, text, map); });
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
  return JsonText(json);
}

std::string FormatMeasuredModel(const std::string& method, const MethodOptions& options,
                                const SignalLog& log) {
  std::string text = std::string(kMeasured) + "\nmethod " + method + "\n";
  const std::vector<const SignalSetting*> of_method = SettingsOf(method, options);
  for (const SignalSetting& setting : SignalSettings()) {
    const bool is_of_method =
        std::find(of_method.begin(), of_method.end(), &setting) != of_method.end();
    if (!is_of_method && setting.get(options) == setting.get(MethodOptions())) continue;
    text += setting.name + " ";
    AppendNumber(&text, setting.get(options));
    text += "\n";
  }
  return text + "log\n" + FormatSignalLog(log);
}

}  // namespace graticule::apps
