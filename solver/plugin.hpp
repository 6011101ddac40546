#pragma once

#include <string>
#include <vector>

#include "graticule/solver/registry.hpp"

namespace graticule {

/// A plug-in that was opened.
struct PluginInfo {
  std::string file, name, version, licence;
  std::vector<std::string> variable_types, factor_types;
};

/// Opens a shared library, checks everything it says, and adds its types to the registry; on
/// failure the registry is as it was.  The library stays open for ever: graphs keep pointers into
/// it.  Throws Error (kMissingType): no such file, not a library, no entry symbol, another ABI
/// version, a table that is not right, a name already taken.
PluginInfo LoadPlugin(const std::string& file, Registry* types);

/// Folders that are searched for plug-ins: GRATICULE_PLUGIN_PATH (colons between), then
/// lib/graticule/plugins of the installation that the running program is in, or else of the one
/// that the library was built for.
std::vector<std::string> PluginPath();

/// Loads every `*.so` of those folders, by name.  Throws as LoadPlugin; folders that are not there
/// are passed over.
std::vector<PluginInfo> LoadPluginsFromPath(Registry* types);

}  // namespace graticule
