#pragma once

#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/replay.hpp"

namespace graticule::apps {

/// A log, and the map that its positions are in.
struct LoadedSignal {
  std::string name;
  SignalLog log;
  std::shared_ptr<const OccupancyGrid> map;  ///< null: none was given
};

/// Throws Error: a file that is refused; as many maps as neither one nor a log each (kUsage); a
/// position outside of the map (kInput).
std::vector<LoadedSignal> LoadSignals(const SignalInput& input);

/// null for no name.
std::shared_ptr<const OccupancyGrid> LoadMap(const std::string& path);

/// The methods' options with the words applied.  Throws Error: a name that is none, a value that is
/// no number.
MethodOptions OptionsOf(const Choosing& choosing);

/// The name that MakePredictor knows: "best", "one" and "gp" are short for others.  Throws Error
/// (kUsage).
std::string MethodOf(const std::string& word);
/// Whether a method predicts through a map, and whether it cannot without one.
bool UsesMap(const std::string& method);
bool NeedsMap(const std::string& method);

/// Throws Error (kUsage): a step that is no time.
ReplayOptions ReplayOptionsOf(const SignalReplayWords& words);

}  // namespace graticule::apps
