// Signal strength predicted on recorded sets: the tables of docs/signal_evaluation.md.
//   graticule_attenuation_replay [--data FOLDER] [--every N] [--leave S] [--forget] [--tune N]
//   [--only NAME]...
//       [--set kolak|kolak-test|grenoble|ikv3|ikv4|LOS_Set_A|...|vehicles-empty|...]
//       [OPTION=NUMBER...] METHOD...
// --tune: searches each METHOD's parameters on the set, by at most N replays a method.

#include <fmt/core.h>

#include <cstdlib>

#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/tune_method.hpp"
#include "graticule/solver/error.hpp"
#include "signal_sets.hpp"

namespace graticule {
namespace {

/// Sets an option by its name: a meta-parameter's, or one of those that are not searched.
void Set(const std::string& name, double value, MethodOptions* options) {
  std::vector<std::pair<std::string, TomographyOptions*>> tomographies = {
      {"one-attenuation-a-class.", &options->one_a_class},
      {"mrt.", &options->mrt},
      {"matte.", &options->matte},
      {"fine-mrt.", &options->fine_mrt}};
  for (const auto& [prefix, tomography] : tomographies) {
    if (name == prefix + "bias")
      tomography->bias = value == 0 ? RadioBias::kNone : RadioBias::kRadio;
    else if (name == prefix + "correlation")
      tomography->correlation = value;
    else if (name == prefix + "merge_m")
      tomography->merge_m = value;
    else
      continue;
    return;
  }
  const std::string process = name.rfind("fine-mrt-gp.", 0) == 0 ? "fine-mrt-gp." : "gp.";
  ResidualGpOptions& gp = process == "gp." ? options->residual_gp : options->fine_mrt_gp;
  GaussianProcessOptions& pair = options->pair_gp;
  if (name == process + "newest")
    gp.newest = static_cast<std::size_t>(value);
  else if (name == process + "nearest")
    gp.nearest = static_cast<std::size_t>(value);
  else if (name == process + "merge_m")
    gp.merge_m = value;
  else if (name == process + "radio_db")
    gp.radio_db = value;
  else if (name == "pair-gp.max_points")
    pair.max_points = static_cast<std::size_t>(value);
  else if (name == "pair-gp.learn")
    pair.learn = value != 0;
  else {
    SetSignalOption(options, name, value);
  }
}

void PrintScores(const std::string& name, const ReplayResult& result) {
  fmt::print("{:<24}|", name);
  for (const int h : {0, 1, 2, 4, 9})
    fmt::print(" {:.3f} ({:.3f}) +-{:.2f}", result.horizons[h].rmse, result.horizons[h].coverage[2],
               result.horizons[h].standard_error / (2 * result.horizons[h].rmse));
  const SignalScore& all = result.all;
  fmt::print(" | {:.3f} {:.3f}", all.negative_log_likelihood, all.crps);
  for (const double share : all.coverage) fmt::print(" {:.3f}", share);
  fmt::print(" | {:.1f} {:.1f}\n", result.update_ms, result.predict_ms);
  const std::vector<double> over_drives = RmseOverDrives(result);
  fmt::print("{:<24}|", "  mean of its drives");
  for (const std::size_t h : {0, 1, 2, 4, 9}) fmt::print(" {:.3f}", over_drives[h]);
  fmt::print("\n");
  std::fflush(stdout);
}

void PrintReplay(const SignalSet& set, const std::vector<std::string>& methods,
                 const MethodOptions& method_options, const ReplayOptions& options) {
  fmt::print("{:<24}|{:^41}|{:^28}| ms: update predict\n", "RMSE [dB], coverage of 90 %",
             "0-2 2-4 4-6 8-10 18-20 s", "all: NLL CRPS 50 68 90 95 %");
  for (const std::string& name : methods)
    PrintScores(name, Replay(
                          set.log,
                          [&] {
                            auto predictor = MakePredictor(name, method_options);
                            predictor->SetMap(set.map);
                            return predictor;
                          },
                          options));
}

void Tune(const SignalSet& set, const std::vector<std::string>& methods, const MethodOptions& start,
          const TuneOptions& options) {
  for (const std::string& name : methods) {
    const TuneResult result = TuneMethod(name, {{set.log, set.map}}, start, options);
    fmt::print("{}: {:.4f} -> {:.4f} by {} replays{}:", name, result.before, result.after,
               result.search.evaluations, result.search.has_converged ? "" : ", not converged");
    for (const SignalSetting* setting : result.settings)
      fmt::print(" {}={:.4g}", setting->name, setting->get(result.options));
    fmt::print("\n");
    std::fflush(stdout);
  }
}

void PrintHoldOuts(const SignalSet& set, const std::vector<std::string>& methods,
                   const MethodOptions& options) {
  const std::pair<const char*, std::vector<HoldOut>> kinds[] = {
      {"random links", {RandomLinks(set.log, 0.2, 1)}},
      {"one end unseen", {UnseenRadios(set.log, 0.2, 1, 1)}},
      {"both ends unseen", {UnseenRadios(set.log, 0.2, 1, 2)}},
      {"frontier", FrontierSweep(set.log, 10)}};
  for (const std::string& name : methods)
    for (const auto& [kind, splits] : kinds) {
      const ReplayResult result =
          EvaluateHoldOut(set.log, splits, [&] { return MakePredictor(name, options); });
      fmt::print("{:<24} {:<18} {:6d} RMSE {:.2f} NLL {:.3f} coverage {:.3f} {:.3f} | {:.0f} ms\n",
                 name, kind, result.all.count, result.all.rmse, result.all.negative_log_likelihood,
                 result.all.coverage[2], result.all.coverage[3],
                 result.update_ms + result.predict_ms);
      std::fflush(stdout);
    }
}

SignalSet Load(const std::string& set, const std::string& folder) {
  if (set == "kolak") return LoadKolak(folder);
  if (set == "kolak-test") return LoadKolakTest(folder);
  if (set == "grenoble") return LoadGrenoble(folder);
  if (set == "ikv3") return LoadIkv(folder, 3);
  if (set == "ikv4") return LoadIkv(folder, 4);
  if (set.compare(0, 9, "vehicles-") == 0) return LoadVehicles(folder, set.substr(9));
  return LoadHarvard(folder, set);
}

int Run(int argc, char** argv) {
  std::string folder = GRATICULE_DATA_DIR "/signal", set = "kolak";
  ReplayOptions options;
  MethodOptions method_options;
  TuneOptions tune;
  bool is_tuning = false;
  std::vector<std::string> methods;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--data" && i + 1 < argc)
      folder = argv[++i];
    else if (word == "--set" && i + 1 < argc)
      set = argv[++i];
    else if (word == "--every" && i + 1 < argc)
      options.every = static_cast<std::size_t>(std::max(1, std::atoi(argv[++i])));
    else if (word == "--leave" && i + 1 < argc)
      options.leave_s = std::atof(argv[++i]);
    else if (word == "--forget")
      options.forget_between_drives = true;
    else if (word == "--tune" && i + 1 < argc) {
      is_tuning = true;
      tune.max_evaluations = static_cast<std::size_t>(std::max(1, std::atoi(argv[++i])));
    } else if (word == "--only" && i + 1 < argc)
      tune.only.push_back(argv[++i]);
    else if (word.find('=') != std::string::npos)
      Set(word.substr(0, word.find('=')), std::atof(word.c_str() + word.find('=') + 1),
          &method_options);
    else
      methods.push_back(word);
  }
  if (methods.empty()) methods = MethodNames();
  tune.replay = options;
  const SignalSet data = Load(set, folder);
  if (is_tuning)
    Tune(data, methods, method_options, tune);
  else if (data.log.has_time)
    PrintReplay(data, methods, method_options, options);
  else
    PrintHoldOuts(data, methods, method_options);
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  try {
    return graticule::Run(argc, argv);
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
