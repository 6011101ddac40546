#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/tune_method.hpp"
#include "problem.hpp"
#include "signal_input.hpp"
#include "spread.hpp"

namespace graticule::apps {
namespace {

// In the midst of a replay Ctrl-C came.
struct Stopped {};

// What is replayed, by every process alike.
class Replays {
 public:
  explicit Replays(const SignalTuneCommand& command) : options_(OptionsOf(command.choosing)) {
    how_.by = command.by == "nll" ? TuneBy::kNegativeLogLikelihood : TuneBy::kMse;
    how_.replay = ReplayOptionsOf(command.replay);
    how_.replay.before_step = [] {
      if (Interruptible::WasAsked()) throw Stopped();
    };
    how_.max_evaluations = static_cast<std::size_t>(command.most);
    for (const std::string& word : command.methods) methods_.push_back(MethodOf(word));
    for (const std::string& method : methods_) only_.push_back(Chosen(method, command.only));
    for (const std::string& name : command.only)
      if (std::none_of(only_.begin(), only_.end(), [&](const std::vector<std::string>& names) {
            return std::count(names.begin(), names.end(), name) > 0;
          }))
        throw Error("--only " + Quoted(name) + ": no method of --methods depends on it",
                    ErrorKind::kUsage);
    for (LoadedSignal& signal : LoadSignals(command.input)) {
      for (const std::string& method : methods_)
        if (NeedsMap(method) && !signal.map)
          throw Error("--map: " + method + " needs a map of " + signal.name, ErrorKind::kUsage);
      logs_.push_back({std::move(signal.log), std::move(signal.map), {}, signal.name});
    }
  }

  const std::vector<std::string>& Methods() const { return methods_; }
  const TuneOptions& How() const { return how_; }

  std::string Shown(double score) const {
    return how_.by == TuneBy::kMse ? fmt::format("mean squared error {:.3f} dB^2", score)
                                   : fmt::format("negative log likelihood {:.4f}", score);
  }

  // The score of a request, as text; empty where it was stopped.
  std::optional<std::string> Handle(const std::string& request) const {
    TextReader reader(request, "request");
    reader.NextLine();
    const auto method = reader.Integer("the method");
    MethodOptions tried = options_;
    for (const SignalSetting* setting : TunedSettings(methods_.at(method), options_, HowOf(method)))
      setting->set(&tried, reader.Double("a setting"));
    std::string text;
    try {
      AppendNumber(&text, TuneScore(methods_[method], logs_, tried, how_));
    } catch (const Stopped&) {
      return std::nullopt;
    }
    return text;
  }

  // Searches by requests: a method's number, and values of its settings.
  TuneResult Search(std::size_t method, const std::string& state_path, const Console& console,
                    const Spread::Handler& handler, Spread* spread) const {
    TuneOptions how = HowOf(method);
    how.state_path = state_path;
    int done = 0;
    how.evaluate = [&](const std::vector<std::vector<double>>& points, const CompassFound& found) {
      std::vector<std::string> requests;
      for (const std::vector<double>& point : points) {
        requests.push_back(std::to_string(method));
        for (const double number : point) AppendNumber(&(requests.back() += ' '), number);
      }
      spread->Run(requests, handler, [&](std::size_t i, const std::string& result) {
        console.Progress(fmt::format("{}: {} replays", methods_[method], ++done));
        double value = HUGE_VAL;
        std::from_chars(result.data(), result.data() + result.size(), value);
        found(i, value);
      });
    };
    return TuneMethod(methods_[method], logs_, options_, how);
  }

 private:
  // Those of the names that a method depends on.  Throws Error: it depends on none.
  std::vector<std::string> Chosen(const std::string& method,
                                  const std::vector<std::string>& names) const {
    std::vector<std::string> chosen;
    for (const SignalSetting* setting : TunedSettings(method, options_, how_))
      if (std::count(names.begin(), names.end(), setting->name) > 0)
        chosen.push_back(setting->name);
    if (chosen.empty() && !names.empty())
      throw Error("--only: " + method + " depends on none of them", ErrorKind::kUsage);
    return chosen;
  }

  TuneOptions HowOf(std::size_t method) const {
    TuneOptions how = how_;
    how.only = only_[method];
    return how;
  }

  MethodOptions options_;
  TuneOptions how_;
  std::vector<std::string> methods_;
  std::vector<std::vector<std::string>> only_;  // of each method; none: all of its settings
  std::vector<TrainingLog> logs_;
};

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
    const TuneResult found =
        replays.Search(m, command.output + "." + method + ".state", console, handler, spread);
    console.Progress("");
    has_converged = has_converged && found.search.has_converged;
    was_stopped = found.search.was_stopped;
    const std::string value =
        std::isnan(found.after) ? "not known yet" : replays.Shown(found.after);
    yaml += fmt::format("# {}: {} over {} steps of {:g} s\n", method, value,
                        replays.How().replay.horizons, replays.How().replay.step_s);
    fmt::print("{}: {} after {} replays{}\n", method, value, found.search.evaluations,
               found.search.has_converged ? "" : "; not yet at its least");
    for (std::size_t i = 0; i < found.settings.size(); ++i) {
      yaml += found.settings[i]->name + ": ";
      AppendNumber(&yaml, found.search.best[i]);
      yaml += "\n";
      fmt::print("  {:<22} {:g}\n", found.settings[i]->name, found.search.best[i]);
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
