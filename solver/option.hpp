#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// One row of an options table: everything that YAML files, `--set`, `--help` and the docs say of
/// an option. `Options` is the struct that the row reads and writes.
template <class Options>
struct OptionRow {
  std::string name;     ///< "max_iterations"
  std::string accepts;  ///< "integer >= 0", "none | huber | cauchy"
  std::string help;     ///< one line
  std::function<std::string(const Options&)> get;
  /// Throws Error (kUsage) if the text does not fit.
  std::function<void(Options&, std::string_view)> set;
};

/// Sets one option by name.  Throws Error (kUsage): no such option (with the nearest one), or a
/// value that does not fit.
template <class Options>
void SetOption(const std::vector<OptionRow<Options>>& table, std::string_view name,
               std::string_view value, Options* options);

}  // namespace graticule
