#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/io/chart.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "problem.hpp"
#include "signal_input.hpp"

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

void AddTo(const SignalScore& one, SignalScore* sum) {
  const auto n = static_cast<double>(one.count);
  sum->count += one.count;
  sum->mse += n * one.mse;
  sum->standard_error += n * n * one.standard_error * one.standard_error;
  sum->negative_log_likelihood += n * one.negative_log_likelihood;
  sum->crps += n * one.crps;
  for (std::size_t i = 0; i < one.coverage.size(); ++i) sum->coverage[i] += n * one.coverage[i];
}

void Divide(SignalScore* sum) {
  if (sum->count == 0) return;
  const auto n = static_cast<double>(sum->count);
  sum->mse /= n;
  sum->rmse = std::sqrt(sum->mse);
  sum->standard_error = std::sqrt(sum->standard_error) / n;
  sum->negative_log_likelihood /= n;
  sum->crps /= n;
  for (double& share : sum->coverage) share /= n;
}

Json ScoreJson(const SignalScore& score) {
  Json json = {{"count", score.count}};
  if (score.count == 0) return json;
  json["mse"] = score.mse;
  json["standard_error"] = score.standard_error;
  json["rmse"] = score.rmse;
  json["nll"] = score.negative_log_likelihood;
  json["crps"] = score.crps;
  for (std::size_t i = 0; i < kCoverageLevels.size(); ++i)
    json["coverage"][fmt::format("{:g}", 100 * kCoverageLevels[i])] = score.coverage[i];
  return json;
}

Json ResultJson(const ReplayResult& result) {
  Json json = {{"method", result.method},
               {"all", ScoreJson(result.all)},
               {"update_ms", result.update_ms},
               {"predict_ms", result.predict_ms},
               {"horizons", Json::array()}};
  for (const SignalScore& score : result.horizons) json["horizons"].push_back(ScoreJson(score));
  return json;
}

void PrintTable(const std::vector<ReplayResult>& results, double step_s) {
  fmt::print("mean squared error [dB^2], and its standard error, of what came after\n{:<24}", "");
  for (std::size_t h = 0; h < results[0].horizons.size(); ++h)
    fmt::print(" {:>12}", fmt::format("{:g}-{:g} s", static_cast<double>(h) * step_s,
                                      static_cast<double>(h + 1) * step_s));
  fmt::print("  |  RMSE   NLL  CRPS | 50 68 90 95 % | ms update predict\n");
  for (const ReplayResult& result : results) {
    fmt::print("{:<24}", result.method);
    for (const SignalScore& score : result.horizons)
      fmt::print(" {:>12}", score.count == 0
                                ? "-"
                                : fmt::format("{:.1f} +-{:.1f}", score.mse, score.standard_error));
    const SignalScore& all = result.all;
    fmt::print("  | {:.2f}  {:.2f}  {:.2f} |", all.rmse, all.negative_log_likelihood, all.crps);
    for (const double share : all.coverage) fmt::print(" {:.0f}", 100 * share);
    fmt::print(" | {:.1f} {:.1f}\n", result.update_ms, result.predict_ms);
  }
}

std::string Figure(const std::vector<ReplayResult>& results, double step_s) {
  CurveChart chart;
  chart.title = "Error of predictions by how far ahead they are";
  chart.x_label = "time ahead [s]";
  chart.y_label = "mean squared error [dB^2]";
  chart.y_scale = AxisScale::kLinear;
  for (std::size_t i = 0; i < results.size(); ++i) {
    Curve curve;
    CurveBand band;
    curve.name = results[i].method;
    band.curve = i;
    for (std::size_t h = 0; h < results[i].horizons.size(); ++h) {
      const SignalScore& score = results[i].horizons[h];
      if (score.count == 0) continue;
      const double x = (static_cast<double>(h) + 0.5) * step_s;
      curve.points.push_back({x, score.mse});
      band.points.push_back(
          {x, score.mse - score.standard_error, score.mse + score.standard_error});
    }
    chart.curves.push_back(std::move(curve));
    chart.bands.push_back(std::move(band));
  }
  return DrawCurves(chart);
}

// The replay of one log by a method.
ReplayResult ReplayOf(const LoadedSignal& signal, const std::string& method,
                      const MethodOptions& options, const ReplayOptions& replay) {
  return About(signal.name, [&] {
    ReplayResult result = Replay(
        signal.log,
        [&] {
          auto predictor = MakePredictor(method, options);
          if (signal.map && UsesMap(method)) predictor->SetMap(signal.map);
          return predictor;
        },
        replay);
    result.method = method;
    return result;
  });
}

// Several logs' results as one: means weighed by counts.
ReplayResult Together(const std::vector<ReplayResult>& results) {
  ReplayResult sum;
  sum.method = results.front().method;
  sum.horizons.resize(results.front().horizons.size());
  for (const ReplayResult& result : results) {
    AddTo(result.all, &sum.all);
    for (std::size_t h = 0; h < sum.horizons.size(); ++h)
      AddTo(result.horizons[h], &sum.horizons[h]);
    sum.update_ms += result.update_ms / static_cast<double>(results.size());
    sum.predict_ms += result.predict_ms / static_cast<double>(results.size());
  }
  Divide(&sum.all);
  for (SignalScore& score : sum.horizons) Divide(&score);
  return sum;
}

}  // namespace

int Run(const SignalEvaluateCommand& command, const Console& console) {
  ReplayOptions replay = ReplayOptionsOf(command.replay);
  replay.forget_between_drives = command.forget;
  if (!command.plot.empty()) {
    ExpectEnding(command.plot, "--plot", {".svg", ".png"});
    ExpectWritable(command.plot);
  }
  const MethodOptions options = OptionsOf(command.choosing);
  const std::vector<LoadedSignal> signals = LoadSignals(command.input);
  std::vector<std::string> methods;
  for (const std::string& word : command.methods) methods.push_back(MethodOf(word));
  bool has_maps = true;
  for (const LoadedSignal& signal : signals) has_maps = has_maps && signal.map != nullptr;
  if (methods.empty())
    for (const char* word : {"log-fit", "persistence", "one", "mrt", "mrgp", "matte", "best"})
      if (has_maps || !NeedsMap(MethodOf(word))) methods.push_back(MethodOf(word));
  for (const std::string& method : methods)
    if (NeedsMap(method) && !has_maps)
      throw Error("--map: " + method + " needs a map of every log", ErrorKind::kUsage);

  std::vector<ReplayResult> parts(methods.size() * signals.size());
  ParallelFor(
      parts.size(), static_cast<std::size_t>(command.threads), [&](std::size_t, std::size_t i) {
        parts[i] =
            ReplayOf(signals[i % signals.size()], methods[i / signals.size()], options, replay);
      });
  std::vector<ReplayResult> results;
  Json json = {{"schema", "graticule-signal-evaluation/1"},
               {"step_s", replay.step_s},
               {"logs", command.input.logs},
               {"methods", Json::array()}};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const std::vector<ReplayResult> of_logs(
        parts.begin() + static_cast<std::ptrdiff_t>(m * signals.size()),
        parts.begin() + static_cast<std::ptrdiff_t>((m + 1) * signals.size()));
    results.push_back(Together(of_logs));
    Json method = ResultJson(results.back());
    for (std::size_t s = 0; s < signals.size() && signals.size() > 1; ++s)
      method["by_log"][signals[s].name] = ResultJson(of_logs[s]);
    json["methods"].push_back(std::move(method));
  }
  if (!command.plot.empty()) {
    const std::string svg = Figure(results, replay.step_s);
    WriteFile(command.plot, Ending(command.plot) == ".png" ? PngFromSvg(svg, 1200) : svg);
    console.Note("wrote " + command.plot);
  }
  if (command.json)
    fmt::print("{}\n", JsonText(json, 1));
  else
    PrintTable(results, replay.step_s);
  return kDone;
}

}  // namespace graticule::apps
