#include "graticule/problems/attenuation/settings.hpp"

#include <algorithm>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {
namespace {

using Matters = std::function<bool(const MethodOptions&)>;

bool Always(const MethodOptions&) { return true; }

// The settings of one method or process; each `at` returns a number's place in the options.
class Settings {
 public:
  Settings(std::string owner, std::vector<SignalSetting>* all)
      : owner_(std::move(owner)), all_(all) {}

  template <class At>
  SignalSetting& Add(const std::string& what, const char* summary, double lower, double upper,
                     At at, Matters matters = Always) {
    all_->push_back({owner_ + "." + what, summary, lower, upper, true, 1,
                     [at](const MethodOptions& options) {
                       MethodOptions copy = options;
                       return double{at(copy)};
                     },
                     [at](MethodOptions* options, double value) { at(*options) = value; },
                     std::move(matters)});
    return all_->back();
  }

 private:
  std::string owner_;
  std::vector<SignalSetting>* all_;
};

void AddTomography(const std::string& owner, TomographyOptions MethodOptions::*of,
                   std::vector<SignalSetting>* all) {
  Settings settings(owner, all);
  const MethodOptions defaults;
  if ((defaults.*of).cell_m > 0) {
    const Matters has_cells = [of](const MethodOptions& o) { return (o.*of).cell_m > 0; };
    settings.Add(
        "cell_m", "m, a cell's side", 0.5, 20,
        [of](MethodOptions& o) -> double& { return (o.*of).cell_m; }, has_cells);
    settings.Add(
        "lambda", "weight of neighbouring cells being alike", 0.05, 100,
        [of](MethodOptions& o) -> double& { return (o.*of).lambda; }, has_cells);
  }
  settings.Add(
      "bias_sigma_db", "dB, deviation of the radios' offsets", 0.1, 30,
      [of](MethodOptions& o) -> double& { return (o.*of).bias_sigma_db; },
      [of](const MethodOptions& o) { return (o.*of).bias != RadioBias::kNone; });
  for (std::size_t c = 0; c < (defaults.*of).classes.size(); ++c) {
    const std::string name = (defaults.*of).classes[c].name;
    SignalSetting& rho = settings.Add(
        "rho_" + name, "dB/m that are expected before anything is measured", -2, 20,
        [of, c](MethodOptions& o) -> double& { return (o.*of).classes[c].rho_db_per_m; });
    rho.is_log = false;
    rho.step = 0.5;
    settings.Add("phi_" + name, "weight of that", 0.05, 100,
                 [of, c](MethodOptions& o) -> double& { return (o.*of).classes[c].phi; });
  }
}

void AddProcess(const std::string& owner, GaussianProcessOptions MethodOptions::*of,
                std::vector<SignalSetting>* all) {
  Settings settings(owner, all);
  const Matters is_given = [of](const MethodOptions& o) { return !(o.*of).learn; };
  const std::size_t first = all->size();
  settings.Add(
      "length_m", "m, over which strengths are alike", 0.05, 200,
      [of](MethodOptions& o) -> double& { return (o.*of).place.length_m; }, is_given);
  settings.Add(
      "sigma_f_db", "dB, deviation of what places have in common", 0.05, 50,
      [of](MethodOptions& o) -> double& { return (o.*of).sigma_f_db; }, is_given);
  settings.Add(
      "sigma_d_db", "dB, deviation of one measurement", 0.1, 50,
      [of](MethodOptions& o) -> double& { return (o.*of).sigma_d_db; }, is_given);
  // What is set by hand is not learnt.
  for (std::size_t i = first; i < all->size(); ++i)
    (*all)[i].set = [of, set = (*all)[i].set](MethodOptions* options, double value) {
      set(options, value);
      (options->*of).learn = false;
    };
}

void AddResidual(const std::string& owner, ResidualGpOptions MethodOptions::*of,
                 std::vector<SignalSetting>* all) {
  Settings settings(owner, all);
  const auto add = [&](const char* what, const char* summary, double lower, double upper,
                       double ResidualGpOptions::*member, const Matters& matters = Always) {
    settings.Add(
        what, summary, lower, upper,
        [of, member](MethodOptions& o) -> double& { return (o.*of).*member; }, matters);
  };
  add("offset_db", "dB, deviation of the whole", 0.05, 20, &ResidualGpOptions::offset_db);
  settings.Add("place_m", "m, over which pairs of places are alike", 0.05, 200,
               [of](MethodOptions& o) -> double& { return (o.*of).place.length_m; });
  add("place_db", "dB, deviation of what they have in common", 0.1, 30,
      &ResidualGpOptions::place_db);
  add("link_db", "dB, deviation of what a link has for a while", 0.1, 30,
      &ResidualGpOptions::link_db);
  add("link_s", "s, that while", 0.25, 600, &ResidualGpOptions::link_s);
  add("radio_db", "dB, deviation of each radio's offset, where the mean has none", 0.1, 30,
      &ResidualGpOptions::radio_db, [of](const MethodOptions& o) { return (o.*of).radio_db > 0; });
  add("noise_db", "dB, deviation of one measurement", 0.3, 30, &ResidualGpOptions::noise_db);
}

std::string OwnerOf(const SignalSetting& setting) {
  return setting.name.substr(0, setting.name.find('.'));
}

bool EndsInGp(const std::string& method) {
  return method.size() > 3 && method.compare(method.size() - 3, 3, "+gp") == 0;
}

// Whose settings a method has.
std::vector<std::string> OwnersOf(const std::string& method) {
  if (method == "combined") return {"matte", "fine-mrt", "gp", "fine-mrt-gp"};
  std::string mean = method;
  while (EndsInGp(mean)) mean.resize(mean.size() - 3);
  if (mean == method) return {mean};
  return {mean, method == "fine-mrt+gp" ? "fine-mrt-gp" : "gp"};
}

}  // namespace

const std::vector<SignalSetting>& SignalSettings() {
  static const std::vector<SignalSetting> settings = [] {
    std::vector<SignalSetting> all;
    AddTomography("matte", &MethodOptions::matte, &all);
    AddTomography("one-attenuation-a-class", &MethodOptions::one_a_class, &all);
    AddTomography("mrt", &MethodOptions::mrt, &all);
    AddTomography("fine-mrt", &MethodOptions::fine_mrt, &all);
    AddProcess("mrgp", &MethodOptions::mrgp, &all);
    AddProcess("pair-gp", &MethodOptions::pair_gp, &all);
    Settings("persistence", &all)
        .Add("decay_s", "s, in which a link's last residuals fade", 0.5, 3600,
             [](MethodOptions& o) -> double& { return o.persistence_s; });
    AddResidual("gp", &MethodOptions::residual_gp, &all);
    AddResidual("fine-mrt-gp", &MethodOptions::fine_mrt_gp, &all);
    return all;
  }();
  return settings;
}

std::vector<const SignalSetting*> SettingsOf(const std::string& method,
                                             const MethodOptions& options) {
  MakePredictor(method, options);  // throws where there is none
  const std::vector<std::string> owners = OwnersOf(method);
  std::vector<const SignalSetting*> found;
  for (const SignalSetting& setting : SignalSettings())
    if (std::find(owners.begin(), owners.end(), OwnerOf(setting)) != owners.end() &&
        setting.matters(options))
      found.push_back(&setting);
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
