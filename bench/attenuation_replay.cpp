// Signal strength predicted on recorded sets: the tables of docs/signal_evaluation.md.
//   graticule_attenuation_replay [--data FOLDER] [--every N] [--forget] [kolak|grenoble]
//       [OPTION=NUMBER...] METHOD...

#include <fmt/core.h>

#include <cstdlib>
#include <map>

#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/solver/error.hpp"
#include "signal_sets.hpp"

namespace graticule {
namespace {

/// Sets an option by its name.
void Set(const std::string& name, double value, MethodOptions* options) {
  TomographyOptions& mrt = options->fine_mrt;
  ResidualGpOptions& gp = options->residual_gp;
  const std::map<std::string, double*> numbers = {{"fine-mrt-cell", &mrt.cell_m},
                                                  {"fine-mrt-lambda", &mrt.lambda},
                                                  {"fine-mrt-phi", &mrt.classes[0].phi},
                                                  {"fine-mrt-correlation", &mrt.correlation},
                                                  {"fine-mrt-merge", &mrt.merge_m},
                                                  {"fine-mrt-bias", &mrt.bias_sigma_db},
                                                  {"gp-length", &gp.place.length_m},
                                                  {"gp-place", &gp.place_db},
                                                  {"gp-link", &gp.link_db},
                                                  {"gp-link-s", &gp.link_s},
                                                  {"gp-offset", &gp.offset_db},
                                                  {"gp-noise", &gp.noise_db},
                                                  {"mrgp-length", &options->mrgp.place.length_m}};
  if (name == "gp-learn")
    gp.learn = value != 0;
  else if (name == "gp-newest")
    gp.newest = static_cast<std::size_t>(value);
  else if (name == "gp-nearest")
    gp.nearest = static_cast<std::size_t>(value);
  else if (numbers.find(name) != numbers.end())
    *numbers.at(name) = value;
  else
    throw Error("there is no option " + name, ErrorKind::kUsage);
}

void PrintKolak(const SignalSet& set, const std::vector<std::string>& methods,
                const MethodOptions& method_options, const ReplayOptions& options) {
  fmt::print("{:<24}|{:^41}|{:^28}| ms: update predict\n", "RMSE [dB], coverage of 90 %",
             "0-2 2-4 4-6 8-10 18-20 s", "all: NLL CRPS 50 68 90 95 %");
  for (const std::string& name : methods) {
    const ReplayResult result = Replay(
        set.log,
        [&] {
          auto predictor = MakePredictor(name, method_options);
          predictor->SetMap(set.map);
          return predictor;
        },
        options);
    fmt::print("{:<24}|", name);
    for (const int h : {0, 1, 2, 4, 9})
      fmt::print(" {:.3f} ({:.3f}) +-{:.2f}", result.horizons[h].rmse,
                 result.horizons[h].coverage[2],
                 result.horizons[h].standard_error / (2 * result.horizons[h].rmse));
    const SignalScore& all = result.all;
    fmt::print(" | {:.3f} {:.3f}", all.negative_log_likelihood, all.crps);
    for (const double share : all.coverage) fmt::print(" {:.3f}", share);
    fmt::print(" | {:.1f} {:.1f}\n", result.update_ms, result.predict_ms);
    std::fflush(stdout);
  }
}

void PrintGrenoble(const SignalSet& set, const std::vector<std::string>& methods,
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

int Run(int argc, char** argv) {
  std::string folder = GRATICULE_DATA_DIR "/signal", set = "kolak";
  ReplayOptions options;
  MethodOptions method_options;
  std::vector<std::string> methods;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--data" && i + 1 < argc)
      folder = argv[++i];
    else if (word == "--every" && i + 1 < argc)
      options.every = static_cast<std::size_t>(std::max(1, std::atoi(argv[++i])));
    else if (word == "--forget")
      options.forget_between_drives = true;
    else if (word == "kolak" || word == "grenoble")
      set = word;
    else if (word.find('=') != std::string::npos)
      Set(word.substr(0, word.find('=')), std::atof(word.c_str() + word.find('=') + 1),
          &method_options);
    else
      methods.push_back(word);
  }
  if (methods.empty()) methods = MethodNames();
  if (set == "kolak")
    PrintKolak(LoadKolak(folder), methods, method_options, options);
  else
    PrintGrenoble(LoadGrenoble(folder), methods, method_options);
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
