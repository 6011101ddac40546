#include <fmt/core.h>

#include <atomic>

#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "graticule/problems/attenuation/tune.hpp"
#include "problem.hpp"
#include "signal_replay.hpp"

namespace graticule::apps {

int Run(const SignalTuneCommand& command, const Console& console) {
  ReplayOptions replay;
  replay.step_s = SecondsOf("--every", command.every);
  replay.horizons = command.horizons;
  replay.every = static_cast<std::size_t>(command.predict_every);
  ExpectEnding(command.output, "--output", {".yaml", ".yml"});
  ExpectWritable(command.output);
  MethodOptions options = OptionsOf(command.choosing);
  std::vector<std::string> methods;
  for (const std::string& word : command.methods) {
    methods.push_back(MethodOf(word));
    if (SettingsOf(methods.back()).empty())
      throw Error("--methods: " + methods.back() + " has nothing to tune", ErrorKind::kUsage);
  }
  const std::vector<LoadedSignal> signals = LoadSignals(command.input);
  for (const std::string& method : methods)
    for (const LoadedSignal& signal : signals)
      if (NeedsMap(method) && !signal.map)
        throw Error("--map: " + method + " needs a map of " + signal.name, ErrorKind::kUsage);

  const Interruptible interruptible;
  std::string yaml;
  bool has_converged = true;
  for (const std::string& method : methods) {
    const std::vector<const SignalSetting*> settings = SettingsOf(method);
    CompassOptions search;
    std::vector<double> start;
    for (const SignalSetting* setting : settings) {
      start.push_back(setting->get(options));
      search.scale.push_back(setting->step);
      search.lower.push_back(setting->lower);
      search.upper.push_back(setting->upper);
    }
    search.last_step = 0.2;
    search.max_evaluations = static_cast<std::size_t>(command.most);
    search.threads = static_cast<std::size_t>(command.threads);
    search.state_path = command.output + "." + method + ".state";
    std::atomic<int> done{0};
    const auto value = [&](const std::vector<double>& at) {
      if (Interruptible::WasAsked())
        throw Error("stopped; the same command goes on from here", ErrorKind::kOther);
      MethodOptions tried = options;
      for (std::size_t i = 0; i < at.size(); ++i) settings[i]->set(&tried, at[i]);
      std::vector<ReplayResult> results;
      for (const LoadedSignal& signal : signals)
        results.push_back(ReplayOf(signal, method, tried, replay));
      console.Progress(fmt::format("{}: {} replays", method, ++done));
      return Together(results).all.mse;
    };
    const CompassResult found = CompassSearch(value, start, search);
    console.Progress("");
    has_converged = has_converged && found.has_converged;
    yaml += fmt::format("# {}: mean squared error {:.3f} dB^2 over {} steps of {:g} s\n", method,
                        found.value, replay.horizons, replay.step_s);
    fmt::print("{}: {:.3f} dB^2 after {} replays{}\n", method, found.value, found.evaluations,
               found.has_converged ? "" : "; not yet at its least");
    for (std::size_t i = 0; i < settings.size(); ++i) {
      settings[i]->set(&options, found.best[i]);
      yaml += settings[i]->name + ": ";
      AppendNumber(&yaml, found.best[i]);
      yaml += "\n";
      fmt::print("  {:<22} {:g}\n", settings[i]->name, found.best[i]);
    }
  }
  WriteFile(command.output, yaml);
  return has_converged ? kDone : kNotConverged;
}

}  // namespace graticule::apps
