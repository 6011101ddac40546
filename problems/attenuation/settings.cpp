#include "graticule/problems/attenuation/settings.hpp"

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {
namespace {

using Get = std::function<double(const MethodOptions&)>;

/// A setting whose place in the options `at` returns.
template <class At>
SignalSetting Make(const char* name, const char* summary, double lower, double upper, double step,
                   At at) {
  return {name,
          summary,
          lower,
          upper,
          step,
          [at](const MethodOptions& options) {
            MethodOptions copy = options;
            return double{at(copy)};
          },
          [at](MethodOptions* options, double value) { at(*options) = value; }};
}

void AddGrid(const std::string& method, TomographyOptions MethodOptions::*options,
             std::vector<SignalSetting>* settings) {
  const auto name = [&](const char* what) { return method + "." + what; };
  settings->push_back(Make(name("lambda").c_str(), "weight of neighbouring cells being alike", 0.1,
                           40, 2,
                           [options](MethodOptions& o) -> double& { return (o.*options).lambda; }));
}

void AddClasses(const std::string& method, TomographyOptions MethodOptions::*options,
                std::vector<SignalSetting>* settings) {
  const char* names[] = {"free", "structure", "unknown"};
  for (std::size_t c = 0; c < 3; ++c)
    settings->push_back(Make((method + ".rho_" + names[c]).c_str(),
                             "dB/m that are expected before anything is measured",
                             c == 1 ? 0.0 : -0.5, c == 1 ? 20 : 5, c == 1 ? 2 : 0.2,
                             [options, c](MethodOptions& o) -> double& {
                               return (o.*options).classes[c].rho_db_per_m;
                             }));
  for (std::size_t c = 0; c < 3; ++c)
    settings->push_back(
        Make((method + ".phi_" + names[c]).c_str(), "weight of that", 0.2, 60, c == 1 ? 2 : 5,
             [options, c](MethodOptions& o) -> double& { return (o.*options).classes[c].phi; }));
}

void AddResidual(const std::string& process, ResidualGpOptions MethodOptions::*of,
                 std::vector<SignalSetting>* settings) {
  const auto add = [&](const char* what, const char* summary, double lower, double upper,
                       double step, double ResidualGpOptions::*member) {
    settings->push_back(
        Make((process + what).c_str(), summary, lower, upper, step,
             [of, member](MethodOptions& o) -> double& { return (o.*of).*member; }));
  };
  add(".place_db", "deviation of what pairs of places have in common", 0.3, 15, 1,
      &ResidualGpOptions::place_db);
  settings->push_back(Make((process + ".place_m").c_str(), "over which they have it in common", 0.2,
                           20, 0.5,
                           [of](MethodOptions& o) -> double& { return (o.*of).place.length_m; }));
  add(".link_db", "deviation of what a link has for a while", 0.3, 15, 1,
      &ResidualGpOptions::link_db);
  add(".link_s", "that while", 0.5, 120, 2, &ResidualGpOptions::link_s);
  add(".noise_db", "deviation of one measurement", 0.5, 15, 0.5, &ResidualGpOptions::noise_db);
}

}  // namespace

const std::vector<SignalSetting>& SignalSettings() {
  static const std::vector<SignalSetting> settings = [] {
    std::vector<SignalSetting> all;
    AddGrid("matte", &MethodOptions::matte, &all);
    AddClasses("matte", &MethodOptions::matte, &all);
    AddClasses("one-attenuation-a-class", &MethodOptions::one_a_class, &all);
    AddGrid("mrt", &MethodOptions::mrt, &all);
    AddGrid("fine-mrt", &MethodOptions::fine_mrt, &all);
    all.push_back(Make("mrgp.length_m", "over which strengths are alike", 1, 60, 8,
                       [](MethodOptions& o) -> double& { return o.mrgp.place.length_m; }));
    all.push_back(Make("persistence.decay_s", "in which a link's last residuals fade", 1, 300, 10,
                       [](MethodOptions& o) -> double& { return o.persistence_s; }));
    AddResidual("gp", &MethodOptions::residual_gp, &all);
    AddResidual("fine-mrt-gp", &MethodOptions::fine_mrt_gp, &all);
    return all;
  }();
  return settings;
}

std::vector<const SignalSetting*> SettingsOf(const std::string& method) {
  std::vector<const SignalSetting*> found;
  const std::size_t plus = method.find("+gp");
  const std::string mean = method.substr(0, plus);
  const std::string process = plus == std::string::npos ? ""
                              : mean == "log-fit"       ? "log-fit-gp"
                                                        : "gp";
  const auto is_combined = [](const std::string& owner) {
    return owner == "fine-mrt" || owner == "matte" || owner == "gp" || owner == "fine-mrt-gp";
  };
  for (const SignalSetting& setting : SignalSettings()) {
    const std::string owner = setting.name.substr(0, setting.name.find('.'));
    if (owner == mean || owner == process || (method == "combined" && is_combined(owner)))
      found.push_back(&setting);
  }
  return found;
}

void SetSignalOption(MethodOptions* options, const std::string& name, double value) {
  std::vector<std::string_view> names;
  for (const SignalSetting& setting : SignalSettings()) {
    if (setting.name == name) {
      setting.set(options, value);
      return;
    }
    names.push_back(setting.name);
  }
  throw Error("there is no signal option " + Quoted(name) + DidYouMean(name, names),
              ErrorKind::kUsage);
}

}  // namespace graticule
