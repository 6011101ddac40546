#pragma once

#include <functional>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/methods.hpp"

namespace graticule {

/// A number of a method's options that may be set by name, and found by compass search (the
/// meta-parameters of the thesis' Table 3.1 and what came to them since): measurements do not tell
/// it while the method runs.
struct SignalSetting {
  std::string name;             ///< "matte.lambda"
  std::string summary;          ///< with its unit
  double lower = 0, upper = 0;  ///< what the search tries
  bool is_log = true;           ///< searched by factors; false: by steps
  double step = 1;              ///< the search's first: a power of two, or a length
  std::function<double(const MethodOptions&)> get;
  std::function<void(MethodOptions*, double)> set;
  /// Whether predictions depend on it as the options are: not on the deviation of biases where
  /// there are none.
  std::function<bool(const MethodOptions&)> matters;
};

/// Every setting that there is, in the order that docs list them.
const std::vector<SignalSetting>& SignalSettings();

/// Those that a method's predictions depend on, of its mean first: "matte" and "matte+gp" have
/// matte.*, "combined" those of its three members.  None (mean, log-fit): nothing is to be tuned.
/// Throws Error (kUsage): no such method.
std::vector<const SignalSetting*> SettingsOf(const std::string& method,
                                             const MethodOptions& options = {});

/// Throws Error (kUsage): no such name.  Whether the value holds, MakePredictor says.
void SetSignalOption(MethodOptions* options, const std::string& name, double value);

}  // namespace graticule
