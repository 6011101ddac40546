#pragma once

#include <functional>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/methods.hpp"

namespace graticule {

/// A number of a method's options that may be set by name, and found by compass search (the
/// meta-parameters of the thesis' Table 3.1).
struct SignalSetting {
  std::string name;  ///< "matte.lambda"
  std::string summary;
  double lower = 0, upper = 0;  ///< what the search tries
  double step = 0;              ///< its first
  std::function<double(const MethodOptions&)> get;
  std::function<void(MethodOptions*, double)> set;
};

/// Every setting that there is, in the order that docs list them.
const std::vector<SignalSetting>& SignalSettings();

/// Those that a method has: "matte" and "matte+gp" have matte.*; none: nothing is to be tuned.
std::vector<const SignalSetting*> SettingsOf(const std::string& method);

/// Throws Error (kUsage): no such name; a value that does not hold.
void SetSignalOption(MethodOptions* options, const std::string& name, double value);

}  // namespace graticule
