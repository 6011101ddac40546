#include "signal_input.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "graticule/io/config.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/ray.hpp"
#include "graticule/problems/attenuation/settings.hpp"

namespace graticule::apps {
namespace {

bool ReadNumber(const std::string& text, double* number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(*number);
}

/// Drops of each link what comes too soon after what was taken.
void Thin(SignalLog* log, double rate_hz) {
  if (!(rate_hz > 0)) return;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> next_s;
  std::vector<SignalMeasurement> kept;
  for (const SignalMeasurement& measurement : log->measurements) {
    const SignalLink& link = measurement.link;
    const auto [place, is_first] =
        next_s.try_emplace({link.receiver, link.transmitter}, link.time_s);
    if (!is_first && link.time_s < place->second - 1e-9) continue;
    place->second = std::max(place->second + 1 / rate_hz, link.time_s);
    kept.push_back(measurement);
  }
  log->measurements = std::move(kept);
}

void ExpectInside(const LoadedSignal& signal) {
  if (!signal.map) return;
  const ClassMap map(*signal.map, {2, 0, 1});
  const double most = TomographyOptions().outside_m;
  for (const SignalMeasurement& measurement : signal.log.measurements)
    for (const Eigen::Vector3d& at :
         {measurement.link.receiver_m, measurement.link.transmitter_m}) {
      const double outside = map.DistanceOutside(at.head<2>());
      if (outside > most)
        throw Error(fmt::format(
            "{}: at {} s a radio is at ({}, {}), {:.1f} m outside of the map; is "
            "the map in the log's frame?",
            signal.name, Shown(measurement.link.time_s), Shown(at.x()), Shown(at.y()), outside));
    }
}

}  // namespace

std::shared_ptr<const OccupancyGrid> LoadMap(const std::string& path) {
  return path.empty() ? nullptr : std::make_shared<const OccupancyGrid>(ReadOccupancy(path));
}

std::vector<LoadedSignal> LoadSignals(const SignalInput& input) {
  if (input.maps.size() > 1 && input.maps.size() != input.logs.size())
    throw Error(fmt::format("--map: {} maps for {} logs; expected one, or one a log",
                            input.maps.size(), input.logs.size()),
                ErrorKind::kUsage);
  SignalLogOptions options;
  options.mobile = input.mobile;
  options.sort = input.sort;
  if (!input.anchors.empty())
    options.anchors = ParseAnchors(ReadFile(input.anchors), input.anchors);
  for (const std::string& word : input.trajectories) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error("--trajectory " + Quoted(word) + ": expected RADIO=FILE", ErrorKind::kUsage);
    const std::string file = word.substr(equals + 1);
    std::vector<StampedPose>& poses = options.trajectories[word.substr(0, equals)];
    poses = ParseTum(ReadFile(file), file);
    ExpectInOrder(poses, file);
  }
  std::vector<LoadedSignal> signals;
  std::map<std::string, std::shared_ptr<const OccupancyGrid>> maps;
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    LoadedSignal signal;
    std::filesystem::path log = input.logs[i];
    std::string map = input.maps.empty() ? "" : input.maps[input.maps.size() > 1 ? i : 0];
    signal.name = input.logs[i];
    if (std::filesystem::is_directory(log)) {
      if (map.empty() && std::filesystem::exists(log / "map.yaml"))
        map = (log / "map.yaml").string();
      log /= std::filesystem::exists(log / "log.csv.gz") ? "log.csv.gz" : "log.csv";
    }
    signal.log = ReadSignalLog(log.string(), options);
    if (!map.empty() && !maps[map]) maps[map] = LoadMap(map);
    if (!map.empty()) signal.map = maps[map];
    Thin(&signal.log, input.rate_hz);
    ExpectInside(signal);
    signals.push_back(std::move(signal));
  }
  return signals;
}

MethodOptions OptionsOf(const Choosing& choosing) {
  MethodOptions options;
  const auto set = [&](const std::string& name, const std::string& text) {
    double value = 0;
    if (!ReadNumber(text, &value))
      throw Error(name + ": expected a number, found " + Quoted(text), ErrorKind::kUsage);
    SetSignalOption(&options, name, value);
  };
  if (!choosing.config.empty())
    for (const ConfigEntry& entry : ParseConfig(ReadFile(choosing.config), choosing.config)) {
      try {
        set(entry.name, entry.value);
      } catch (const Error& error) {
        throw Error(choosing.config, entry.line, entry.column, error.what());
      }
    }
  for (const std::string& setting : choosing.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos)
      throw Error("--set " + Quoted(setting) + ": expected NAME=VALUE", ErrorKind::kUsage);
    set(setting.substr(0, equals), setting.substr(equals + 1));
  }
  return options;
}

std::string MethodOf(const std::string& word) {
  const std::size_t plus = std::min(word.find('+'), word.size());
  std::string name = word.substr(0, plus);
  if (name == "best") name = kBestMethod;
  if (name == "one") name = "one-attenuation-a-class";
  if (name == "gp") name = "pair-gp";
  name += word.substr(plus);
  MakePredictor(name);
  return name;
}

bool UsesMap(const std::string& method) { return NeedsMap(method) || method == kBestMethod; }

bool NeedsMap(const std::string& method) {
  return method.rfind("matte", 0) == 0 || method.rfind("one-attenuation", 0) == 0;
}

ReplayOptions ReplayOptionsOf(const SignalReplayWords& words) {
  ReplayOptions replay;
  const std::string& every = words.every;  // "2s" or "2"
  const bool has_unit = !every.empty() && every.back() == 's';
  if (!ReadNumber(has_unit ? every.substr(0, every.size() - 1) : every, &replay.step_s) ||
      !(replay.step_s > 0))
    throw Error("--every " + Quoted(every) + ": expected seconds above zero, as 2s",
                ErrorKind::kUsage);
  replay.horizons = words.horizons;
  replay.every = static_cast<std::size_t>(words.predict_every);
  return replay;
}

}  // namespace graticule::apps
