#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "graticule/io/checksum.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "graticule/problems/attenuation/tune.hpp"
#include "graticule/solver/provenance.hpp"
#include "problem.hpp"
#include "signal_replay.hpp"
#include "spread.hpp"

namespace graticule::apps {
namespace {

// In the midst of a replay Ctrl-C came.
struct Stopped {};

// What is replayed, by every process alike.
class Replays {
 public:
  explicit Replays(const SignalTuneCommand& command) : options_(OptionsOf(command.choosing)) {
    replay_.step_s = SecondsOf("--every", command.every);
    replay_.horizons = command.horizons;
    replay_.every = static_cast<std::size_t>(command.predict_every);
    for (const std::string& word : command.methods) {
      methods_.push_back(MethodOf(word));
      if (SettingsOf(methods_.back()).empty())
        throw Error("--methods: " + methods_.back() + " has nothing to tune", ErrorKind::kUsage);
    }
    signals_ = LoadSignals(command.input);
    for (const std::string& method : methods_)
      for (const LoadedSignal& signal : signals_)
        if (NeedsMap(method) && !signal.map)
          throw Error("--map: " + method + " needs a map of " + signal.name, ErrorKind::kUsage);
  }

  const std::vector<std::string>& Methods() const { return methods_; }
  const MethodOptions& Options() const { return options_; }
  const ReplayOptions& How() const { return replay_; }

  // A method with these numbers, as a request.
  static std::string Request(std::size_t method, const std::vector<double>& numbers) {
    std::string text = std::to_string(method);
    for (const double number : numbers) {
      text += ' ';
      AppendNumber(&text, number);
    }
    return text;
  }

  // Its mean squared error over all logs [dB^2], as text; empty where it was stopped.
  std::optional<std::string> Handle(const std::string& request) const {
    TextReader reader(request, "request");
    reader.NextLine();
    const std::string& method = methods_.at(reader.Integer("the method"));
    MethodOptions tried = options_;
    for (const SignalSetting* setting : SettingsOf(method))
      setting->set(&tried, reader.Double("a setting"));
    ReplayOptions replay = replay_;
    replay.before_step = [] {
      if (Interruptible::WasAsked()) throw Stopped();
    };
    std::vector<ReplayResult> results;
    try {
      for (const LoadedSignal& signal : signals_)
        results.push_back(ReplayOf(signal, method, tried, replay));
    } catch (const Stopped&) {
      return std::nullopt;
    }
    std::string text;
    AppendNumber(&text, Together(results).all.mse);
    return text;
  }

  // One word for all that values depend on beside the numbers that are searched for.
  std::string Fingerprint(const std::string& method) const {
    std::string text = method;
    const auto add = [&](double number) {
      text += ' ';
      AppendNumber(&text, number);
    };
    for (const double number : {replay_.step_s, static_cast<double>(replay_.horizons),
                                static_cast<double>(replay_.every)})
      add(number);
    for (const SignalSetting& setting : SignalSettings()) add(setting.get(options_));
    for (const auto& [what, version] : Provenance()) text += ' ' + what + ' ' + version;
    for (const LoadedSignal& signal : signals_) text += ' ' + graticule::apps::Fingerprint(signal);
    return Checksum(text);
  }

 private:
  MethodOptions options_;
  ReplayOptions replay_;
  std::vector<std::string> methods_;
  std::vector<LoadedSignal> signals_;
};

CompassResult Search(std::size_t method, const Replays& replays, const SignalTuneCommand& command,
                     const Console& console, const Spread::Handler& handler, Spread* spread) {
  const std::string& name = replays.Methods()[method];
  CompassOptions search;
  std::vector<double> start;
  for (const SignalSetting* setting : SettingsOf(name)) {
    start.push_back(setting->get(replays.Options()));
    search.scale.push_back(setting->step);
    search.lower.push_back(setting->lower);
    search.upper.push_back(setting->upper);
  }
  search.last_step = 0.2;
  search.max_evaluations = static_cast<std::size_t>(command.most);
  search.state_path = command.output + "." + name + ".state";
  search.state_of = replays.Fingerprint(name);
  int done = 0;
  const CompassEvaluate evaluate = [&](const std::vector<std::vector<double>>& points,
                                       const CompassFound& found) {
    std::vector<std::string> requests;
    for (const std::vector<double>& point : points)
      requests.push_back(Replays::Request(method, point));
    spread->Run(requests, handler, [&](std::size_t i, const std::string& result) {
      console.Progress(fmt::format("{}: {} replays", name, ++done));
      double value = HUGE_VAL;
      std::from_chars(result.data(), result.data() + result.size(), value);
      found(i, value);
    });
  };
  return CompassSearch(evaluate, start, search);
}

int Tune(const SignalTuneCommand& command, const Console& console, Spread* spread) {
  if (spread->IsRoot()) {
    ExpectEnding(command.output, "--output", {".yaml", ".yml"});
    ExpectWritable(command.output);
  }
  const Replays replays(command);
  const Spread::Handler handler = [&](const std::string& request) {
    return replays.Handle(request);
  };
  const Interruptible interruptible;
  if (!spread->IsRoot()) {
    spread->Serve(handler);
    return kDone;
  }
  std::string yaml;
  bool has_converged = true, was_stopped = false;
  for (std::size_t m = 0; m < replays.Methods().size() && !was_stopped; ++m) {
    const std::string& method = replays.Methods()[m];
    const CompassResult found = Search(m, replays, command, console, handler, spread);
    console.Progress("");
    has_converged = has_converged && found.has_converged;
    was_stopped = found.was_stopped;
    const std::string value =
        std::isnan(found.value) ? "not known yet" : fmt::format("{:.3f} dB^2", found.value);
    yaml += fmt::format("# {}: mean squared error {} over {} steps of {:g} s\n", method, value,
                        replays.How().horizons, replays.How().step_s);
    fmt::print("{}: {} after {} replays{}\n", method, value, found.evaluations,
               found.has_converged ? "" : "; not yet at its least");
    std::size_t i = 0;
    for (const SignalSetting* setting : SettingsOf(method)) {
      yaml += setting->name + ": ";
      AppendNumber(&yaml, found.best[i]);
      yaml += "\n";
      fmt::print("  {:<22} {:g}\n", setting->name, found.best[i++]);
    }
  }
  WriteFile(command.output, yaml);
  if (was_stopped) console.Note("stopped; the same command goes on from here");
  return has_converged ? kDone : kNotConverged;
}

}  // namespace

int Run(const SignalTuneCommand& command, const Console& console) {
  return WithSpread(static_cast<std::size_t>(command.threads),
                    [&](Spread* spread) { return Tune(command, console, spread); });
}

}  // namespace graticule::apps
