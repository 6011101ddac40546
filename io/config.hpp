#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// One line of a configuration, as written: what it means is decided by whoever knows the options.
struct ConfigEntry {
  std::string name;
  std::string value;
  std::size_t line = 0;  ///< of the name; lines and columns count from 1
  std::size_t column = 0;
};

/// Reads a configuration: YAML, one flat mapping of names to plain values.  An empty file is an
/// empty configuration.  Throws Error "name:line:column: ...": not YAML, not a mapping, nested, a
/// name twice, no value.
std::vector<ConfigEntry> ParseConfig(std::string_view text, const std::string& name);

}  // namespace graticule
