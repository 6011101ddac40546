#include "graticule/problems/attenuation/tune_method.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/checksum.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/provenance.hpp"

namespace graticule {
namespace {

using Settings = std::vector<const SignalSetting*>;

// The search's coordinate of a setting's value, and back.  Zero, which no factor leads to, is where
// the least that is tried is.
double Coordinate(const SignalSetting& setting, double value) {
  if (!setting.is_log) return value;
  return std::log2(value > 0 ? value : setting.lower);
}

double Value(const SignalSetting& setting, double coordinate) {
  return setting.is_log ? std::exp2(coordinate) : coordinate;
}

template <class... Numbers>
void AddNumbers(std::string* text, Numbers... numbers) {
  for (const double number : {static_cast<double>(numbers)...}) {
    *text += ' ';
    AppendNumber(text, number);
  }
}

void AddMap(std::string* text, const OccupancyGrid& map) {
  AddNumbers(text, map.resolution, map.map_from_grid.x, map.map_from_grid.y, map.map_from_grid.yaw,
             map.width);
  for (const Occupancy cell : map.cells) *text += static_cast<char>('0' + static_cast<int>(cell));
}

// One word for a log's measurements and its maps, whatever files they came from.
std::string Fingerprint(const TrainingLog& training) {
  std::string text;
  for (const std::string& radio : training.log.radios) text += radio + '\n';
  AddNumbers(&text, training.log.has_time, training.log.has_height);
  for (const SignalMeasurement& measurement : training.log.measurements) {
    const SignalLink& link = measurement.link;
    AddNumbers(&text, link.time_s, link.receiver, link.transmitter, link.receiver_m.x(),
               link.receiver_m.y(), link.receiver_m.z(), link.transmitter_m.x(),
               link.transmitter_m.y(), link.transmitter_m.z(), measurement.dbm,
               measurement.is_heard);
  }
  if (training.map) AddMap(&text, *training.map);
  for (const TimedMap& map : training.maps) {
    AddNumbers(&text, map.time_s);
    AddMap(&text, *map.map);
  }
  return Checksum(text);
}

// One word for all that a score depends on beside the settings that are searched.
std::string Fingerprint(const std::string& method, const std::vector<TrainingLog>& logs,
                        const MethodOptions& start, const Settings& searched,
                        const TuneOptions& options) {
  std::string text = method;
  AddNumbers(&text, static_cast<int>(options.by), options.replay.step_s, options.replay.horizons,
             options.replay.every, options.replay.forget_between_drives, options.replay.new_drive_s,
             options.replay.leave_s);
  for (const SignalSetting& setting : SignalSettings()) AddNumbers(&text, setting.get(start));
  for (const SignalSetting* setting : searched) text += ' ' + setting->name;
  for (const auto& [what, version] : Provenance()) text += ' ' + what + ' ' + version;
  for (const TrainingLog& log : logs) text += ' ' + Fingerprint(log);
  return Checksum(text);
}

double Score(const std::string& method, const TrainingLog& training,
             const MethodOptions& method_options, const TuneOptions& options) {
  const auto make = [&]() -> std::unique_ptr<SignalPredictor> {
    auto predictor = MakePredictor(method, method_options);
    if (training.map) predictor->SetMap(training.map);
    if (training.maps.empty()) return predictor;
    return std::make_unique<GrowingMap>(std::move(predictor), training.maps);
  };
  const SignalScore all = Replay(training.log, make, options.replay).all;
  if (all.count == 0)
    throw Error("nothing to predict: it ends before the replay's first step has passed");
  return options.by == TuneBy::kMse ? all.mse : all.negative_log_likelihood;
}

}  // namespace

std::vector<const SignalSetting*> TunedSettings(const std::string& method,
                                                const MethodOptions& start,
                                                const TuneOptions& options) {
  Settings all = SettingsOf(method, start);
  if (all.empty()) throw Error(method + " has nothing to tune", ErrorKind::kUsage);
  if (options.only.empty()) return all;
  Settings chosen;
  for (const std::string& name : options.only) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const SignalSetting* setting) {
      return setting->name == name;
    });
    if (found == all.end())
      throw Error("tune: " + method + " has no setting " + Quoted(name), ErrorKind::kUsage);
    chosen.push_back(*found);
  }
  return chosen;
}

double TuneScore(const std::string& method, const std::vector<TrainingLog>& logs,
                 const MethodOptions& method_options, const TuneOptions& options) {
  double sum = 0;
  for (const TrainingLog& training : logs) {
    try {
      sum += Score(method, training, method_options, options);
    } catch (const Error& error) {
      if (training.name.empty() || error.Kind() == ErrorKind::kUsage) throw;
      throw Error(training.name + ": " + error.what(), error.Kind());
    }
  }
  return sum / static_cast<double>(logs.size());
}

TuneResult TuneMethod(const std::string& method, const std::vector<TrainingLog>& logs,
                      const MethodOptions& start, const TuneOptions& options) {
  if (logs.empty()) throw Error("tune: no log to tune on", ErrorKind::kUsage);
  TuneResult result;
  result.settings = TunedSettings(method, start, options);
  const Settings& settings = result.settings;

  CompassOptions search;
  search.first_step = options.first_step;
  search.last_step = options.last_step;
  search.max_evaluations = options.max_evaluations;
  search.state_path = options.state_path;
  if (!options.state_path.empty())
    search.state_of = Fingerprint(method, logs, start, settings, options);
  std::vector<double> from;
  for (const SignalSetting* setting : settings) {
    from.push_back(Coordinate(*setting, setting->get(start)));
    search.scale.push_back(setting->step);
    search.lower.push_back(Coordinate(*setting, setting->lower));
    search.upper.push_back(Coordinate(*setting, setting->upper));
  }
  // What was not moved stays as it was given, to the digit.
  const auto values = [&](std::vector<double> x) {
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = x[i] == from[i] ? settings[i]->get(start) : Value(*settings[i], x[i]);
    return x;
  };
  const auto with = [&](const std::vector<double>& numbers) {
    MethodOptions there = start;
    for (std::size_t i = 0; i < numbers.size(); ++i) settings[i]->set(&there, numbers[i]);
    return there;
  };
  if (options.evaluate) {
    const CompassEvaluate evaluate = [&](const std::vector<std::vector<double>>& points,
                                         const CompassFound& found) {
      std::vector<std::vector<double>> numbers;
      for (const std::vector<double>& point : points) numbers.push_back(values(point));
      options.evaluate(numbers, found);
    };
    result.search = CompassSearch(evaluate, from, search);
  } else {
    search.threads = options.threads;
    result.search = CompassSearch(
        [&](const std::vector<double>& x) {
          return TuneScore(method, logs, with(values(x)), options);
        },
        from, search);
  }
  result.before = result.search.start_value;
  result.after = result.search.value;
  result.search.best = values(result.search.best);
  result.options = with(result.search.best);
  return result;
}

}  // namespace graticule
