#pragma once

#include <map>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "graticule/io/signal_log.hpp"
#include "graticule/problems/attenuation/settings.hpp"

namespace graticule::python {

/// (n, 3) positions of the links' ends [m].
struct EndArrays {
  py::array_t<double> receivers_m, transmitters_m;
};

/// Links from arrays: ends (n, 2) or (n, 3) [m], radios and times (n,) or none.
std::vector<SignalLink> LinksOf(const Dense<double>& receivers_m,
                                const Dense<double>& transmitters_m,
                                const std::optional<Dense<std::int64_t>>& receivers,
                                const std::optional<Dense<std::int64_t>>& transmitters,
                                const std::optional<Dense<double>>& times_s);
std::vector<SignalLink> LinksOf(const SignalLog& log);

/// Settings by name, on top of the defaults.  Throws Error (kUsage): no such name.
inline MethodOptions OptionsOf(const std::map<std::string, double>& settings) {
  MethodOptions options;
  for (const auto& [name, value] : settings) SetSignalOption(&options, name, value);
  return options;
}

}  // namespace graticule::python
