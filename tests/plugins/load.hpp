#pragma once

#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/plugin.hpp"

namespace graticule::testing {

inline std::string PluginFile(const std::string& name) {
  return std::string(PLUGIN_DIR) + "/lib" + name + ".so";
}

/// The names of all types of a registry.
inline std::vector<std::string> Names(const Registry& types) {
  std::vector<std::string> names;
  for (const VariableType* type : types.VariableTypes()) names.push_back(type->name);
  for (const FactorType* type : types.FactorTypes()) names.push_back(type->name);
  return names;
}

/// The built-in types and those of some plug-ins.
inline Registry With(const std::vector<std::string>& plugins) {
  Registry types = Builtins();
  for (const std::string& name : plugins) LoadPlugin(PluginFile(name), &types);
  return types;
}

}  // namespace graticule::testing
